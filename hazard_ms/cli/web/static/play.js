// Play: a person chooses what the robot does.

import { element } from "./api.js"
import { Rescue } from "./rescue.js"
import { form, listed } from "./setup.js"

const KEPT = "hazard_ms play" // in sessionStorage: the rescue that this tab shows
const KEYS = [["1–9", "take the choice with that number"], ["m", "go to the list of things"], ["c", "go to the choices"],
  ["+ −", "faster, slower"], ["w", "let the world wait, or run on"], ["Tab, Enter", "go on, choose"]]
const PACES = [1, 2, 4, 8, 16]

export async function mount(part, api) {
  const setup = await api("/api/setup")
  const stage = element("div"), start = element("div", { class: "start" })
  part.replaceChildren(start, stage)
  let rescue = null

  function open(name) {
    if (rescue) rescue.leave()
    sessionStorage.setItem(KEPT, name)
    start.hidden = true
    rescue = new Rescue(name, api, message => { if (message.type === "state") world.textContent = message.runs_on ? "Let the world wait" : "Let the world run on" })
    const world = element("button", { class: "live", onclick: () => rescue.ask({ do: "world", runs_on: !(rescue.state && rescue.state.runs_on) }) }, "Let the world run on")
    rescue.buttons.append(world,
      element("button", { class: "live", onclick: () => pace(-1) }, "Slower"), element("button", { class: "live", onclick: () => pace(1) }, "Faster"),
      element("button", { onclick: leave }, "Another rescue"))
    rescue.root.append(keys())
    stage.replaceChildren(rescue.root)
  }

  function pace(step) {
    const at = PACES.indexOf(rescue.every || (rescue.state && rescue.state.every) || 4)
    rescue.every = PACES[Math.min(Math.max(at + step, 0), PACES.length - 1)]
    rescue.ask({ do: "pace", every: rescue.every })
    rescue.now.textContent = `One picture every ${rescue.every} frames.`
  }

  async function leave() {
    if (rescue) rescue.leave()
    rescue = null
    sessionStorage.removeItem(KEPT)
    start.hidden = false
    await fill()
  }

  async function fill() {
    start.replaceChildren(
      element("p", { class: "soft" }, "Rescue what you can before fire, flood or wind takes it. You choose what the robot does, as the agents of the benchmark do."),
      form(setup, ["view", "runs_on"], async row => open((await api("/api/rescues", { body: { ...row, kind: "play" } })).name)),
      await listed(api, "play", open))
  }

  document.addEventListener("keydown", event => {
    if (part.hidden || !rescue || event.ctrlKey || event.altKey || event.metaKey || /^(INPUT|SELECT|TEXTAREA)$/.test(event.target.tagName)) return
    const deeds = { m: () => rescue.things.focus(), c: () => rescue.choices.querySelector("button")?.focus(), "+": () => pace(1), "-": () => pace(-1),
      w: () => rescue.ask({ do: "world", runs_on: !(rescue.state && rescue.state.runs_on) }) }
    if (/^[1-9]$/.test(event.key)) rescue.number(Number(event.key))
    else if (deeds[event.key]) deeds[event.key]()
    else return
    event.preventDefault()
  })
  part.addEventListener("open", event => open(event.detail))
  const kept = sessionStorage.getItem(KEPT)
  if (kept) open(kept)
  else await fill()
}

export function keys(more = KEYS) {
  return element("details", { open: true }, element("summary", {}, "Keys"),
    element("p", { class: "row" }, ...more.map(([key, what]) => element("span", {}, element("kbd", {}, key), ` ${what}`))))
}
