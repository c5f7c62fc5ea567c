// The tables of a comparison: scores, differences, episodes, and files that are left out.

import { element } from "./api.js"
import { FEW, drawn, interval, look, named, percent } from "./compare_words.js"

const ROWS = 100 // of the table of episodes at a time

const heading = (text, more = {}) => element("th", { scope: "col", ...more }, text)

export function scores(numbers) {
  const agents = Object.entries(numbers.agents)
  const regret = agents.some(([, row]) => row.regret)
  const judged = agents.some(([, row]) => row.lost)
  const heads = ["Value, %", "Step, frames", "Damage, %", ...(regret ? ["Regret, %"] : []), "Rescued", "n"]
  const rows = agents.map(([agent, row], number) => element("tr", {},
    element("th", { scope: "row" }, sample(number), named(agent, numbers.people.includes(agent))),
    cell(interval(row.value, row.episodes)), cell(interval(row.step, row.episodes, 1)), cell(interval(row.damage, row.episodes)),
    regret ? cell(interval(row.regret, row.episodes)) : null, cell(`${row.rescued} of ${row.targets}`),
    element("td", { class: "n" }, String(row.episodes), row.episodes < FEW ? element("span", { class: "soft" }, " few") : null)))
  const notes = [
    `n: episodes; [ ]: 95 % bootstrap intervals over them, which say little where n is below ${FEW}.`,
    regret ? "Regret: the share of the oracle's Value that is missing, on the episodes that both played." : "",
    judged ? "" : "What lost value, and why: run hazard-ms regret on these folders.",
  ]
  return [element("h2", {}, "Scores"),
    element("div", { class: "wide" }, element("table", { class: "compare-scores" },
      element("thead", {}, element("tr", {}, heading("Agent"), ...heads.map(text => heading(text, { class: "n" })))),
      element("tbody", {}, ...rows))),
    element("p", { class: "soft" }, notes.join(" "))]
}

export function differences(numbers) {
  const agents = Object.keys(numbers.agents)
  if (agents.length < 2) return []
  const apart = new Map(numbers.differences.map(row => [JSON.stringify([row.agent, row.other]), row]))
  const rows = agents.map(agent => element("tr", {}, element("th", { scope: "row" }, named(agent, numbers.people.includes(agent))),
    ...agents.map(other => {
      const row = apart.get(JSON.stringify([agent, other]))
      if (!row) return cell("")
      const clear = row.episodes >= FEW && (row.value.low > 0 || row.value.high < 0)
      return element("td", { class: "n" }, element(clear ? "b" : "span", {}, interval(row.value, row.episodes, 100, true)),
        element("span", { class: "soft compare-small" }, `n = ${row.episodes}`))
    })))
  return [element("details", { class: "compare-part" }, element("summary", {}, "Differences of Value, paired by episode"),
    element("div", { class: "wide" }, element("table", { class: "compare-scores" },
      element("thead", {}, element("tr", {}, heading("Agent minus …"), ...agents.map(agent => heading(element("bdi", {}, agent), { class: "n" })))),
      element("tbody", {}, ...rows))),
    element("p", { class: "soft" }, `In per cent of all value, on the episodes that both played. Bold: the interval does not hold 0, and n is at least ${FEW}.`))]
}

// Episodes by scene, to be sorted and chosen from: `parts` to show, and `mark`, which shows the ones chosen.
export function episodes(numbers, chosen, choose) {
  const agents = Object.keys(numbers.agents)
  const rows = numbers.rows.map(row => ({ ...row, spread: spread(row) }))
  const body = element("tbody"), more = element("button", { type: "button", onclick: () => { shown += ROWS; fill() } })
  const columns = [
    { name: "Episode", of: row => row.scene, then: row => row.seed },
    ...agents.map(agent => ({ name: agent, of: row => row.cells[agent]?.value ?? null })),
    { name: "Spread", of: row => row.spread },
  ]
  let shown = ROWS, marked = new Set(chosen), order = { column: columns[0], down: false }

  const heads = columns.map(column => {
    const button = element("button", { type: "button", class: "compare-sort", onclick: () => sort(column) }, element("bdi", {}, column.name))
    return element("th", { scope: "col", class: column === columns[0] ? "" : "n" }, button)
  })

  function sort(column) {
    order = { column, down: order.column === column ? !order.down : column !== columns[0] }
    fill()
  }

  function fill() {
    rows.sort((a, b) => compared(a, b, order))
    heads.forEach((head, number) => {
      const own = columns[number] === order.column
      head.setAttribute("aria-sort", own ? (order.down ? "descending" : "ascending") : "none")
    })
    body.replaceChildren(...rows.slice(0, shown).map(row => line(row, agents, choose)))
    const left = rows.length - shown
    more.hidden = left <= 0
    more.textContent = `Show ${Math.min(ROWS, left)} more of ${left}`
    const first = body.querySelector("button")
    if (first) first.tabIndex = 0
    mark(marked)
  }

  function mark(keys) {
    marked = new Set(keys)
    for (const button of body.querySelectorAll("button[data-key]")) button.setAttribute("aria-pressed", String(marked.has(button.dataset.key)))
  }

  body.addEventListener("keydown", move)
  fill()
  const table = element("table", { class: "compare-episodes" }, element("thead", {}, element("tr", {}, ...heads)), body)
  return { mark, parts: [element("h2", {}, "Episodes"),
    element("p", { class: "soft" },
      "Value in per cent. Choose a Value, or an episode with all its agents, to see the decisions over one another below; arrow keys move in the table. ",
      "Spread: the best Value less the worst."),
    element("div", { class: "wide compare-tall" }, table), more] }
}

function line(row, agents, choose) {
  const all = agents.flatMap(agent => (row.cells[agent] ? [row.cells[agent].key] : []))
  const episode = `${row.scene}, seed ${row.seed}`
  return element("tr", {},
    element("th", { scope: "row" }, element("button", { type: "button", tabIndex: -1, onclick: () => choose(all) }, element("bdi", {}, episode))),
    ...agents.map(agent => {
      const found = row.cells[agent]
      if (!found) return element("td", { class: "n soft" }, "–")
      const button = element("button", {
        type: "button", tabIndex: -1, class: "compare-value", "data-key": found.key, onclick: () => choose([found.key]),
        "aria-label": `${agent}, ${episode}: Value ${percent(found.value)} %, ended: ${found.ended}`, title: `ended: ${found.ended}`,
      }, percent(found.value))
      button.style.setProperty("--share", `${Math.round(100 * found.value)}%`)
      return element("td", { class: "n" }, button)
    }),
    cell(percent(row.spread)))
}

// Arrow keys, Home and End go from button to button of the table's body; one of them can be reached with Tab.
function move(event) {
  const button = event.target.closest("button"), line = button?.closest("tr")
  if (!line) return
  const own = [...line.querySelectorAll("button")], place = button.parentElement.cellIndex
  const beside = { ArrowRight: own[own.indexOf(button) + 1], ArrowLeft: own[own.indexOf(button) - 1], Home: own[0], End: own.at(-1) }
  const other = { ArrowDown: line.nextElementSibling, ArrowUp: line.previousElementSibling }[event.key]
  const wanted = beside[event.key] ?? (other && (other.cells[place].querySelector("button") ?? other.querySelector("button")))
  if (!wanted) return
  event.preventDefault()
  for (const old of event.currentTarget.querySelectorAll("button[tabindex='0']")) old.tabIndex = -1
  wanted.tabIndex = 0
  wanted.focus()
}

// Missing Values come last, whichever way is up; equal ones are in the order of scenes and seeds.
function compared(a, b, { column, down }) {
  const [x, y] = [column.of(a), column.of(b)]
  if ((x === null) !== (y === null)) return x === null ? 1 : -1
  const sign = down ? -1 : 1
  if (x !== y && x !== null) return sign * (x < y ? -1 : 1)
  if (column.then && a.seed !== b.seed) return sign * (a.seed - b.seed)
  return a.scene === b.scene ? a.seed - b.seed : a.scene < b.scene ? -1 : 1
}

function spread(row) {
  const values = Object.values(row.cells).map(found => found.value)
  return values.length > 1 ? Math.max(...values) - Math.min(...values) : null
}

export function leftOut(files, total, said) {
  if (!total) return element("span", { hidden: true })
  const more = total > files.length ? [element("li", {}, `and ${total - files.length} more`)] : []
  return element("details", { class: "compare-part" }, element("summary", {}, `${total} file${total === 1 ? "" : "s"} ${said}`),
    element("ul", {}, ...files.map(file => element("li", { class: "soft" }, element("bdi", {}, file.name), ": ", element("bdi", {}, file.reason))), ...more))
}

function cell(text) {
  return element("td", { class: "n" }, text)
}

function sample(number) {
  const { name, dashes } = look(number)
  return drawn("svg", { class: "compare-sample", width: 26, height: 12, viewBox: "0 0 26 12", "aria-hidden": "true" },
    drawn("line", { x1: 0, x2: 26, y1: 6, y2: 6, class: `line ${name}`, "stroke-dasharray": dashes }))
}
