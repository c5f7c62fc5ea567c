// Watch: one agent, or two side by side on the same seed; pause, step, go back, take over.

import { element } from "./api.js"
import { keys } from "./play.js"
import { Rescue } from "./rescue.js"
import { form, listed } from "./setup.js"

const KEPT = "hazard_ms watch" // in sessionStorage: the rescues that this tab shows
const KEYS = [["p", "pause, go on"], ["s", "one decision more"], ["b", "one decision back"], ["t", "take over from here"], ["Tab, Enter", "go on, choose"]]

export async function mount(part, api) {
  const setup = await api("/api/setup")
  const start = element("div"), stage = element("div", { class: "beside" }), tools = element("div", { class: "row tools" })
  part.replaceChildren(start, tools, stage)
  let shown = [], paused = false

  const all = message => shown.forEach(rescue => rescue.ask(message))
  const hold = element("button", { onclick: () => pause(!paused) }, "Pause")
  function pause(wanted) {
    paused = wanted
    hold.textContent = paused ? "Go on" : "Pause"
    all({ do: paused ? "pause" : "go" })
  }
  function step() { pause(true); all({ do: "step" }) }

  async function jump(rescue, decisions) {
    paused = true
    hold.textContent = "Go on"
    try { await api(`/api/rescues/${rescue.name}/jump`, { body: { decisions } }) } catch (error) { rescue.say(error.message, true) }
  }

  async function takeOver(rescue, decisions = rescue.rows.length) {
    pause(true)
    try {
      const { name } = await api(`/api/rescues/${rescue.name}/take_over`, { body: { decisions } })
      sessionStorage.setItem("hazard_ms play", name)
      document.getElementById("play").dispatchEvent(new CustomEvent("open", { detail: name }))
      document.getElementById("tab-play").click()
    } catch (error) { rescue.say(error.message, true) }
  }

  function open(names) {
    sessionStorage.setItem(KEPT, JSON.stringify(names))
    shown.forEach(rescue => rescue.leave())
    start.hidden = true
    shown = names.map(name => {
      const rescue = new Rescue(name, api)
      rescue.asking.hidden = true
      rescue.jump = number => element("button", { title: "Go back to before this decision", "aria-label": `Go back to before decision ${number}`, onclick: () => jump(rescue, number) }, String(number))
      rescue.buttons.append(element("button", { onclick: () => jump(rescue, Math.max(0, rescue.rows.length - 1)) }, "One back"),
        element("button", { onclick: () => takeOver(rescue) }, "Take over from here"))
      return rescue
    })
    stage.replaceChildren(...shown.map(rescue => rescue.root))
    stage.classList.toggle("two", shown.length > 1)
    tools.replaceChildren(hold, element("button", { onclick: step }, "One decision"), element("button", { onclick: leave }, "Others"), keys(KEYS))
  }

  async function leave() {
    shown.forEach(rescue => rescue.leave())
    shown = []
    paused = false
    sessionStorage.removeItem(KEPT)
    tools.replaceChildren()
    start.hidden = false
    await fill()
  }

  async function fill() {
    start.replaceChildren(element("p", { class: "soft" }, "Watch agents decide, with their reasons. Two agents get the same scene and seed."),
      form(setup, ["agent", "second"], async (row, second) => {
        const agents = second ? [row.agent, second] : [row.agent]
        const names = []
        for (const agent of agents) names.push((await api("/api/rescues", { body: { ...row, agent, kind: "watch" } })).name)
        open(names)
      }), await listed(api, "watch", name => open([name])))
  }

  document.addEventListener("keydown", event => {
    if (part.hidden || !shown.length || event.ctrlKey || event.altKey || event.metaKey || /^(INPUT|SELECT|TEXTAREA)$/.test(event.target.tagName)) return
    const deeds = { p: () => pause(!paused), s: step, b: () => shown.forEach(rescue => jump(rescue, Math.max(0, rescue.rows.length - 1))), t: () => takeOver(shown[0]) }
    if (!deeds[event.key]) return
    deeds[event.key]()
    event.preventDefault()
  })
  const kept = sessionStorage.getItem(KEPT)
  if (kept) open(JSON.parse(kept))
  else await fill()
}
