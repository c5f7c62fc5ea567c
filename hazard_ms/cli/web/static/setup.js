// The form in which a rescue is chosen, for Play and Watch, and the list of those that can be gone on with.

import { element } from "./api.js"

const NAMES = { env_id: "task", split: "split", scene: "scene", seed: "seed", robot_uids: "robot", physics: "physics",
  severity: "severity", lighting: "light", every: "pace", view: "pictures", runs_on: "the world", agent: "agent", second: "beside it" }
const PACES = { 1: "slowest", 2: "slow", 4: "usual", 8: "fast", 16: "fastest" }

function select(name, options, chosen) {
  const made = element("select", { name }, ...options.map(([value, text]) => element("option", { value }, text)))
  if (chosen !== undefined) made.value = chosen
  return made
}

const same = names => names.map(name => [name, name])

// `fields` are names of further fields, of Play: view and runs_on, of Watch: agent and second
export function form(setup, fields, begin) {
  const inputs = {
    env_id: select("env_id", same(setup.tasks.map(task => task.name))),
    split: select("split", []),
    scene: select("scene", []),
    seed: element("input", { name: "seed", type: "number", min: 0, max: 4294967295, value: 0 }),
    robot_uids: select("robot_uids", same(setup.robots)),
    physics: select("physics", same(setup.physics)),
    severity: select("severity", same(setup.severity), "severe"),
    lighting: select("lighting", same(setup.lighting)),
    every: select("every", setup.every.map(pace => [pace, PACES[pace] || pace]), "4"),
    view: select("view", [["all", "all"], ["robot", "only the robot's own"]]),
    runs_on: select("runs_on", [["", "waits for me"], ["yes", "runs on while I think"]]),
    agent: select("agent", same(setup.agents.map(agent => agent.name)), "greedy"),
    second: select("second", [["", "nobody"], ...same(setup.agents.map(agent => agent.name))]),
  }
  const shown = ["env_id", "split", "scene", "seed", "robot_uids", "physics", "severity", "lighting", "every", ...fields]
  const text = element("p", { class: "soft" }), fault = element("p", { class: "bad", role: "alert" })
  const follow = () => {
    const task = setup.tasks.find(each => each.name === inputs.env_id.value)
    const split = inputs.split.value in task.splits ? inputs.split.value : Object.keys(task.splits)[0]
    inputs.split.replaceChildren(...Object.keys(task.splits).map(name => element("option", { value: name }, name)))
    inputs.split.value = split
    inputs.scene.replaceChildren(element("option", { value: "" }, "by the seed"), ...task.splits[split].map(name => element("option", { value: name }, name)))
    inputs.severity.disabled = inputs.physics.value !== "realistic"
    text.textContent = task.text
  }
  for (const name of ["env_id", "split", "physics"]) inputs[name].addEventListener("change", follow)
  follow()
  const start = element("button", { class: "main", type: "submit" }, "Start")
  return element("form", { class: "card", onsubmit: async event => {
    event.preventDefault()
    fault.textContent = ""
    start.disabled = true
    const row = {}
    for (const name of shown) if (!inputs[name].disabled && name !== "second") row[name] = inputs[name].value
    row.seed = Number(row.seed)
    row.every = Number(row.every)
    if ("runs_on" in row) row.runs_on = row.runs_on === "yes"
    if (!row.scene) delete row.scene
    try { await begin(row, inputs.second.value) } catch (error) { fault.textContent = error.message }
    start.disabled = false
  } }, element("div", { class: "fields" }, ...shown.map(name => element("label", {}, NAMES[name], inputs[name])), start), text, fault)
}

export async function listed(api, kind, open) {
  const found = (await api("/api/rescues")).filter(row => row.kind === kind)
  if (!found.length) return element("div")
  const rows = found.map(row => {
    const item = element("li", { class: "row" }, element("span", {}, `${row.task}, ${row.scene || `seed ${row.seed}`}, ${row.agent}, ${row.decisions} decisions${row.over ? ", over: its film is missing" : ""}`),
      element("button", { onclick: () => open(row.name) }, "Go on"),
      element("button", { onclick: async () => { await api(`/api/rescues/${row.name}/end`, { body: {} }); item.remove() } }, "Delete"))
    return item
  })
  return element("div", { class: "card" }, element("h3", {}, "Rescues under way"), element("ul", { class: "plain" }, ...rows))
}
