// How the comparison writes numbers and names, and the colours that it gives.

import { element } from "./api.js"

export const FEW = 10 // episodes, below which an interval says little [ours]
const COLOURS = 6, DASHES = ["", "7 4", "2 3", "10 3 2 3"]
const VERBS = ["walk_to", "walk_one_step", "pick_up", "drop", "explore", "stop"]

export const percent = share => (share === null || share === undefined ? "–" : (100 * share).toFixed(1))

// A score with its 95 % interval; one episode has none.
export function interval(score, episodes, factor = 100, sign = false) {
  if (!score || score.mean === null) return "–"
  const shown = value => `${sign && value > 0 ? "+" : ""}${(factor * value).toFixed(1)}`.replace("-", "−")
  return score.low === null || episodes === 1 ? shown(score.mean) : `${shown(score.mean)} [${shown(score.low)}, ${shown(score.high)}]`
}

export const words = name => name.replaceAll("_", " ")

// The name of an agent; people are marked as such.
export function named(agent, person) {
  return element("span", {}, element("bdi", {}, agent), person ? element("span", { class: "compare-person" }, "a person") : null)
}

// The class of an agent's colour and the dashes of its lines: together they differ for 24 agents.
export function look(number) {
  return { name: `agent-${number % COLOURS}`, dashes: DASHES[(number + Math.floor(number / COLOURS)) % DASHES.length] }
}

// The class of a skill's colour; that of others for verbs that are not ours.
export const verbClass = verb => `verb-${VERBS.includes(verb) ? verb : "other"}`

const SVG = "http://www.w3.org/2000/svg"

// An element of a drawing; text becomes text.
export function drawn(name, attributes = {}, ...children) {
  const made = document.createElementNS(SVG, name)
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value)
  made.append(...children)
  return made
}

// What the colours of a drawing mean: [class, words, dashes] each.
export function legend(entries) {
  return element("ul", { class: "compare-legend" }, ...entries.map(([name, said, dashes]) => {
    const sample = dashes === undefined
      ? drawn("rect", { width: 18, height: 12, class: name })
      : drawn("line", { x1: 0, x2: 26, y1: 6, y2: 6, class: `line ${name}`, "stroke-dasharray": dashes })
    const width = dashes === undefined ? 18 : 26
    return element("li", {}, drawn("svg", { width, height: 12, viewBox: `0 0 ${width} 12`, "aria-hidden": "true" }, sample), element("bdi", {}, said))
  }))
}
