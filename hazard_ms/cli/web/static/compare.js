// Results of folders beside one another: which folders, which settings, and what there is to see about them.

import { element } from "./api.js"
import { plots } from "./compare_charts.js"
import { differences, episodes, leftOut, scores } from "./compare_tables.js"
import { Timelines } from "./compare_timelines.js"
import { named } from "./compare_words.js"

const MOST_CHOSEN = 12 // episodes whose timelines are shown at once, as the server allows

export function mount(place, api) {
  style()
  const page = new Comparison(place, api)
  void page.start()
}

function style() {
  if (document.querySelector("link[data-compare]")) return
  document.head.append(element("link", { rel: "stylesheet", href: "/static/compare.css", "data-compare": "" }))
}

class Comparison {
  constructor(place, api) {
    this.api = api
    this.folders = [] // keys of those chosen
    this.chosen = [] // keys of the episodes whose timelines are shown
    this.asked = 0 // so that a late answer to an older question is not shown
    this.status = element("p", { class: "soft", role: "status" })
    this.folderPlace = element("div")
    this.groupPlace = element("div", { class: "row compare-settings" })
    this.numberPlace = element("div")
    this.timelines = new Timelines(api, key => this.choose(key))
    place.replaceChildren(this.folderPlace, this.groupPlace, this.status, this.numberPlace, this.timelines.place)
  }

  async start() {
    await this.told(async () => {
      const found = await this.api("/api/compare/folders")
      this.folders = this.folders.filter(key => found.folders.some(folder => folder.key === key))
      this.showFolders(found)
      await this.showGroups()
    })
  }

  // Runs a task, and shows in words why it failed.
  async told(task) {
    this.status.className = "soft"
    this.status.textContent = "Reading the results …"
    try {
      await task()
      if (this.status.textContent.endsWith("…")) this.status.textContent = ""
    } catch (error) {
      this.status.className = "bad"
      this.status.textContent = error.message
    }
  }

  showFolders(found) {
    const boxes = found.folders.map(folder => this.folderBox(folder))
    const all = found.folders.reduce((sum, folder) => sum + folder.results, 0)
    const again = element("button", { type: "button", onclick: () => this.start() }, "Read again")
    this.folderPlace.replaceChildren(
      element("details", { class: "card", open: found.folders.length > 1 },
        element("summary", {}, `${count(all, "result")} in ${count(found.folders.length, "folder")}`),
        element("fieldset", { class: "compare-folders" },
          element("legend", { class: "soft" }, "Folders to compare; none chosen: all"), ...boxes)),
      element("p", {}, again),
      leftOut(found.refused, found.refused_count, "cannot be shown"))
    if (!all) {
      this.folderPlace.append(element("p", {},
        "There are no results yet. Play a rescue, or run hazard-ms evaluate -o FOLDER and start hazard-ms serve --folder FOLDER."))
    }
  }

  folderBox(folder) {
    const box = element("input", {
      type: "checkbox", checked: this.folders.includes(folder.key),
      onchange: () => {
        this.folders = this.folders.filter(key => key !== folder.key)
        if (box.checked) this.folders.push(folder.key)
        void this.told(() => this.showGroups())
      },
    })
    const settings = folder.settings.slice(0, 3).join("; ") + (folder.settings.length > 3 ? "; …" : "")
    const agents = folder.agents.map(agent => element("span", { class: "compare-name" }, named(agent.name, agent.person)))
    return element("label", {}, box, element("span", {},
      element("bdi", {}, folder.name), ` · ${count(folder.results, "result")}`,
      element("span", { class: "soft compare-small" }, element("bdi", {}, settings), ...agents)))
  }

  query() {
    return this.folders.map(key => `folder=${encodeURIComponent(key)}`)
  }

  async showGroups() {
    const asked = ++this.asked
    const { groups } = await this.api(`/api/compare/groups?${this.query().join("&")}`)
    if (asked !== this.asked) return
    const options = groups.map(group => element("option", { value: group.settings },
      `${group.settings} (${count(group.results, "result")})`))
    const select = element("select", { id: "compare-settings", onchange: () => this.told(() => this.showNumbers(select.value)) }, ...options)
    this.groupPlace.replaceChildren(element("label", { htmlFor: "compare-settings" }, "Task and settings"), select)
    this.groupPlace.hidden = !groups.length
    const kept = groups.find(group => group.settings === this.settings) ?? groups[0]
    if (!kept) {
      this.numberPlace.replaceChildren()
      this.timelines.clear()
      return
    }
    select.value = kept.settings
    await this.showNumbers(kept.settings)
  }

  async showNumbers(settings) {
    const asked = ++this.asked
    if (settings !== this.settings) this.chosen = []
    this.settings = settings
    const query = [`settings=${encodeURIComponent(settings)}`, ...this.query()].join("&")
    const numbers = await this.api(`/api/compare/numbers?${query}`)
    if (asked !== this.asked) return
    const there = new Set(numbers.rows.flatMap(row => Object.values(row.cells).map(cell => cell.key)))
    this.chosen = this.chosen.filter(key => there.has(key))
    this.table = episodes(numbers, this.chosen, keys => this.choose(...keys))
    this.numberPlace.replaceChildren(
      ...scores(numbers), ...differences(numbers), ...plots(numbers), ...this.table.parts,
      leftOut(numbers.left_out, numbers.left_out_count, "left out of this comparison"))
    await this.timelines.show(this.chosen)
  }

  // Adds episodes to those whose timelines are shown, or takes them away if all of them are there.
  choose(...keys) {
    const added = keys.filter(key => !this.chosen.includes(key))
    this.chosen = added.length ? [...this.chosen, ...added] : this.chosen.filter(key => !keys.includes(key))
    const many = this.chosen.length > MOST_CHOSEN
    this.chosen = this.chosen.slice(-MOST_CHOSEN)
    this.table.mark(this.chosen)
    void this.told(async () => {
      await this.timelines.show(this.chosen)
      this.status.textContent = many ? `The last ${MOST_CHOSEN} episodes are shown.` : ""
    })
  }
}

function count(number, what) {
  return `${number.toLocaleString("en")} ${what}${number === 1 ? "" : "s"}`
}
