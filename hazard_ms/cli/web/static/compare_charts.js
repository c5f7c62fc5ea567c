// The plots of a comparison: value over time, fates of targets, frames by skill, and what lost value.

import { element } from "./api.js"
import { drawn, legend, look, percent, verbClass, words } from "./compare_words.js"

const LEFT = 44, RIGHT = 14, TOP = 10, BOTTOM = 26, TICKS = 5 // margins [pixels]; steps of the axis of frames
const OUTCOMES = ["done", "unfinished", "failed"]
const FATES = ["rescued whole", "rescued damaged", "whole", "damaged"]
const PARTS = ["perception", "memory", "format", "latency", "mitigation", "planning", "unseen", "small", "execution", "ended"]
const PART_WORDS = { unseen: "targets not seen yet", small: "small regrets", execution: "execution of skills", ended: "the agent failed" }

export const partWords = part => PART_WORDS[part] ?? part

export function plots(numbers) {
  const agents = Object.keys(numbers.agents)
  const made = [
    part("Value over time", valueChart(numbers, agents),
      legend(agents.map((agent, number) => [look(number).name, agent, look(number).dashes])),
      element("p", { class: "soft" }, "Mean share of all value that is rescued by each frame.")),
    part("Survival of targets", element("div", { class: "compare-small-plots" }, ...agents.map(agent => fates(numbers, agent))),
      legend(FATES.map(fate => [`fate-${fate.replace(" ", "-")}`, fate]))),
    part("Frames by skill", ...skills(numbers, agents)),
  ]
  const judged = agents.filter(agent => numbers.agents[agent].lost)
  if (judged.length) made.push(part("What lost value", ...losses(numbers, judged)))
  return made
}

function part(title, ...children) {
  return element("details", { class: "compare-part", open: true }, element("summary", {}, title), ...children)
}

function valueChart(numbers, agents) {
  const size = [1000, 300], end = numbers.frames.at(-1)
  const highest = Math.max(...agents.flatMap(agent => numbers.values[agent]))
  const top = Math.max(0.2, Math.ceil(highest * 10 - 1e-9) / 10)
  const lines = agents.map((agent, number) => drawn("polyline", {
    class: `line ${look(number).name}`, "stroke-dasharray": look(number).dashes,
    points: points(numbers.frames, numbers.values[agent].map(share => share / top), end, size),
  }, drawn("title", {}, agent)))
  const said = agents.map(agent => `${agent} ${percent(numbers.values[agent].at(-1))} %`).join(", ")
  return chart(size, `Value over ${end} frames; at the end: ${said}`, ...axes(end, top, 0.1, size), ...lines)
}

function fates(numbers, agent) {
  const size = [420, 170], end = numbers.frames.at(-1), low = numbers.frames.map(() => 0)
  const areas = FATES.map(fate => {
    const high = numbers.fates[agent][fate].map((share, k) => low[k] + share)
    const outline = `${points(numbers.frames, high, end, size)} ${points([...numbers.frames].reverse(), [...low].reverse(), end, size)}`
    high.forEach((share, k) => { low[k] = share })
    return drawn("polygon", { class: `fate-${fate.replace(" ", "-")}`, points: outline }, drawn("title", {}, fate))
  })
  const said = FATES.map(fate => `${percent(numbers.fates[agent][fate].at(-1))} % ${fate}`).join(", ")
  return element("figure", {}, element("figcaption", {}, element("bdi", {}, agent)),
    chart(size, `Fates of the targets of ${agent} at the end: ${said}`, ...areas, ...axes(end, 1, 0.25, size)))
}

function skills(numbers, agents) {
  const verbs = [...new Set(agents.flatMap(agent => Object.keys(numbers.agents[agent].skills)))].sort()
  const frames = (agent, verb, outcome) => (numbers.agents[agent].skills[verb]?.[outcome].frames ?? 0) / numbers.agents[agent].episodes
  const rows = agents.map(agent => [agent, verbs.flatMap(verb => OUTCOMES.map(outcome => ({
    class: `${verbClass(verb)} outcome-${outcome}`, length: frames(agent, verb, outcome),
    said: `${words(verb)}, ${outcome}: ${frames(agent, verb, outcome).toFixed(0)} frames an episode`,
  })))])
  const table = numberTable(["Frames an episode", ...verbs.map(words)], agents.map(agent => [agent, ...verbs.map(verb => {
    const [done, unfinished, failed] = OUTCOMES.map(outcome => frames(agent, verb, outcome))
    return `${(done + unfinished + failed).toFixed(0)}${failed >= 0.5 ? `, ${failed.toFixed(0)} failed` : ""}`
  })]))
  return [bars(rows, "frames", "Frames by skill"),
    legend([...verbs.map(verb => [verbClass(verb), words(verb)]), ["verb-other outcome-unfinished", "unfinished"], ["verb-other outcome-failed", "failed"]]), table]
}

function losses(numbers, agents) {
  const shares = agent => numbers.agents[agent].lost.shares
  const rows = agents.map(agent => [agent, PARTS.filter(name => shares(agent)[name] > 0).map(name => ({
    class: `part-${name}`, length: 100 * shares(agent)[name], said: `${partWords(name)}: ${percent(shares(agent)[name])} %`,
  }))])
  const table = numberTable(["Lost, % of the value", ...PARTS.map(partWords), "episodes"],
    agents.map(agent => [agent, ...PARTS.map(name => percent(shares(agent)[name])), numbers.agents[agent].lost.episodes]))
  return [bars(rows, "%", "Value lost by part"), legend(PARTS.map(name => [`part-${name}`, partWords(name)])), table]
}

// A bar for each row [name, pieces], of pieces one beside the other; lengths in `unit`.
function bars(rows, unit, label) {
  const names = 150, step = 30, width = 1000
  const total = pieces => pieces.reduce((sum, piece) => sum + piece.length, 0)
  const longest = Math.max(1e-9, ...rows.map(([, pieces]) => total(pieces)))
  const scale = (width - names - 100) / longest
  const lines = rows.flatMap(([name, pieces], number) => {
    let x = names
    const y = 6 + number * step
    const made = pieces.filter(piece => piece.length > 0).map(piece => {
      const rect = drawn("rect", { x: x.toFixed(1), y, width: Math.max(piece.length * scale - 1, 0.3).toFixed(1), height: 20, class: piece.class }, drawn("title", {}, piece.said))
      x += piece.length * scale
      return rect
    })
    const short = name.length > 20 ? `${name.slice(0, 19)}…` : name
    return [text(names - 8, y + 15, short, "end"), ...made, text(x + 6, y + 15, `${total(pieces).toFixed(unit === "%" ? 1 : 0)} ${unit}`, "start")]
  })
  return chart([width, 8 + step * rows.length], label, ...lines)
}

function numberTable(heads, rows) {
  return element("details", {}, element("summary", {}, "Numbers"), element("div", { class: "wide" }, element("table", {},
    element("thead", {}, element("tr", {}, ...heads.map((head, k) => element("th", { scope: "col", class: k ? "n" : "" }, head)))),
    element("tbody", {}, ...rows.map(([name, ...cells]) => element("tr", {}, element("th", { scope: "row" }, element("bdi", {}, name)),
      ...cells.map(cell => element("td", { class: "n" }, String(cell)))))))))
}

// Narrow screens scroll a drawing sideways: its words would be too small to read.
function chart([width, height], label, ...children) {
  return element("div", { class: "compare-plot" },
    drawn("svg", { viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": label, class: width > 600 ? "large" : "" }, ...children))
}

function points(frames, shares, end, [width, height]) {
  return frames.map((frame, k) => {
    const x = LEFT + (width - LEFT - RIGHT) * frame / end, y = TOP + (height - TOP - BOTTOM) * (1 - shares[k])
    return `${x.toFixed(1)},${y.toFixed(1)}`
  }).join(" ")
}

function axes(end, top, step, [width, height]) {
  const made = []
  for (let k = 0; k <= TICKS; k++) {
    made.push(text(LEFT + (width - LEFT - RIGHT) * k / TICKS, height - 8, (end * k / TICKS).toFixed(0), k === TICKS ? "end" : "middle"))
  }
  for (let k = 0; k <= Math.round(top / step); k++) {
    const y = height - BOTTOM - (height - TOP - BOTTOM) * k * step / top
    made.push(drawn("line", { x1: LEFT, x2: width - RIGHT, y1: y, y2: y, class: "grid" }), text(LEFT - 6, y + 4, `${Math.round(100 * step * k)} %`, "end"))
  }
  return made
}

function text(x, y, said, anchor) {
  return drawn("text", { x, y, "text-anchor": anchor }, said)
}
