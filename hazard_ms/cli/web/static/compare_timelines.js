// The decisions of chosen episodes over one another on one axis of time, with rescues, damage and regret.

import { element, opened } from "./api.js"
import { partWords } from "./compare_charts.js"
import { drawn, legend, named, percent, verbClass, words } from "./compare_words.js"

const NARROWEST = 720 // of a timeline [pixels]
const SIDE = 12, MARKS = 14, BAR = 26, DEEPEST = 26, AXIS = 18 // margin; heights of its parts [pixels]
const FULL_REGRET = 0.25 // share of the value at which the bar of a regret is as long as can be
const MOST_ZOOM = 16, WORST = 3 // decisions of an episode that are listed
const SKILLS = ["walk_to", "pick_up", "drop", "explore", "stop", "other"]

export class Timelines {
  constructor(api, remove) {
    this.api = api
    this.remove = remove
    this.episodes = []
    this.zoom = 1
    this.asked = 0
    this.lanes = element("div", { class: "compare-lanes" })
    this.said = element("div", { class: "card compare-said" })
    this.place = element("section", { hidden: true, "aria-labelledby": "compare-timelines" },
      element("h2", { id: "compare-timelines" }, "Decisions compared"),
      element("p", { class: "row" },
        element("button", { type: "button", onclick: () => this.zoomed(2) }, "Wider"),
        element("button", { type: "button", onclick: () => this.zoomed(0.5) }, "Narrower"),
        element("span", { class: "soft" }, "Tab reaches a timeline; ", key("←"), " ", key("→"), " go from decision to decision, ", key("↑"), " ", key("↓"),
          " to the other episodes at that time, ", key("+"), " ", key("−"), " stretch the time.")),
      legend([...SKILLS.map(verb => [verbClass(verb), words(verb)]), ["verb-other outcome-unfinished", "unfinished"], ["verb-other outcome-failed", "failed"],
        ["verb-wait", "thinking"], ["regret", "regret, below"]]),
      element("p", { class: "soft" }, "▲ rescued whole  △ rescued damaged  ✕ damaged"),
      this.lanes, this.said)
    this.lanes.addEventListener("keydown", event => this.pressed(event))
    new ResizeObserver(() => { if (this.lanes.clientWidth !== this.drawnFor) this.draw() }).observe(this.lanes)
  }

  clear() {
    this.episodes = []
    this.place.hidden = true
  }

  async show(keys) {
    const asked = ++this.asked
    if (!keys.length) return this.clear()
    const { episodes } = await this.api(`/api/compare/episodes?${keys.map(one => `key=${encodeURIComponent(one)}`).join("&")}`)
    if (asked !== this.asked) return
    this.episodes = episodes
    this.place.hidden = false
    this.tell(null)
    this.draw()
  }

  zoomed(factor) {
    this.zoom = Math.min(MOST_ZOOM, Math.max(1, this.zoom * factor))
    this.draw()
  }

  draw() {
    if (!this.episodes.length || this.place.hidden) return
    const at = this.place.contains(document.activeElement) ? document.activeElement.dataset?.place : undefined
    this.end = Math.max(...this.episodes.map(one => one.max_frames))
    this.drawnFor = this.lanes.clientWidth
    this.width = Math.max(NARROWEST, this.drawnFor) * this.zoom
    this.lanes.replaceChildren(...this.episodes.map((one, number) => this.lane(one, number)))
    if (at) this.focus(this.lanes.querySelector(`[data-place="${at}"]`))
  }

  x(frame) {
    return SIDE + (this.width - 2 * SIDE) * Math.min(frame, this.end) / this.end
  }

  lane(one, number) {
    const height = MARKS + BAR + DEEPEST + AXIS
    const picture = drawn("svg", {
      width: this.width, height, viewBox: `0 0 ${this.width} ${height}`, role: "group",
      "aria-label": `${one.agent}, ${one.scene}, seed ${one.seed}: ${one.decisions.length} decisions`,
    }, ...this.axis(height), drawn("line", { class: "cursor", y1: 0, y2: height, x1: -9, x2: -9 }),
    drawn("rect", { class: "over", x: this.x(one.frames), y: MARKS, width: Math.max(0, this.x(this.end) - this.x(one.frames)), height: BAR },
      drawn("title", {}, `ended: ${one.ended}`)),
    ...one.decisions.map((decision, k) => this.bar(one, decision, number, k)), ...one.targets.flatMap(target => this.marks(target)))
    return element("article", {}, head(one, () => this.remove(one.key)), element("div", { class: "compare-picture" }, picture), this.lost(one, number))
  }

  axis(height) {
    const step = [50, 100, 200, 500, 1000, 5000, 50000].find(size => (this.width * size) / this.end > 60) ?? this.end
    const made = []
    for (let frame = 0; frame <= this.end; frame += step) {
      const x = this.x(frame)
      made.push(drawn("line", { class: "grid", x1: x, x2: x, y1: MARKS, y2: height - AXIS + 2 }), drawn("text", { x, y: height - 4, "text-anchor": frame === this.end ? "end" : frame ? "middle" : "start" }, String(frame)))
    }
    return made
  }

  bar(one, decision, number, k) {
    const begun = this.x(decision.frame + decision.waited), width = Math.max(2, this.x(decision.frame + decision.waited + decision.frames) - begun - 1)
    const parts = [drawn("rect", { x: begun, y: MARKS, width, height: BAR, rx: 2, class: `${verbClass(decision.verb)} outcome-${decision.outcome}` })]
    if (decision.waited) parts.unshift(drawn("rect", { class: "verb-wait", x: this.x(decision.frame), y: MARKS + BAR / 3, width: begun - this.x(decision.frame), height: BAR / 3 }))
    if (width > 54) parts.push(drawn("text", { class: "on-bar", x: begun + 4, y: MARKS + BAR / 2 + 4 }, words(decision.verb).slice(0, Math.floor(width / 8))))
    const lost = decision.regret?.lost ?? 0
    if (lost > 0.001) {
      const deep = Math.max(2, DEEPEST * Math.min(1, lost / FULL_REGRET))
      parts.push(drawn("rect", { class: "regret", x: begun, y: MARKS + BAR + 2, width: Math.max(3, width), height: deep }))
    }
    const made = drawn("g", { class: "decision", tabindex: k ? -1 : 0, role: "img", "aria-label": inWords(decision), "data-place": `${number}-${k}` }, ...parts)
    made.addEventListener("focus", () => this.tell(one, decision))
    made.addEventListener("pointerenter", () => this.tell(one, decision))
    made.addEventListener("click", () => this.focus(made))
    return made
  }

  marks(target) {
    const made = []
    const mark = (frame, sign, kind, said) => made.push(drawn("text", { class: `mark ${kind}`, x: this.x(frame), y: MARKS - 3, "text-anchor": "middle" }, sign, drawn("title", {}, said)))
    if (target.damaged !== null) mark(target.damaged, "✕", "bad", `frame ${target.damaged}: ${target.name}, value ${target.value}, damaged`)
    if (target.rescued !== null) {
      mark(target.rescued, target.whole ? "▲" : "△", "good", `frame ${target.rescued}: ${target.name}, value ${target.value}, rescued${target.whole ? "" : " damaged"}`)
    }
    return made
  }

  // What was lost and where most of it: each a way to the decision.
  lost(one, number) {
    if (!one.lost) return element("p", { class: "soft" }, "Regret: not judged; run hazard-ms regret on its folder.")
    const parts = Object.entries(one.lost.parts).filter(([, share]) => Math.abs(share) >= 0.0005).map(([part, share]) => `${partWords(part)} ${percent(share)} %`)
    const worst = one.decisions.map((decision, k) => ({ decision, k })).filter(({ decision }) => decision.regret?.cause)
      .sort((a, b) => b.decision.regret.lost - a.decision.regret.lost).slice(0, WORST)
    return element("div", {},
      element("p", { class: "soft" }, `The best plan from the start: ${percent(one.lost.start)} %. Lost: ${parts.join(", ") || "nothing"}.`),
      worst.length ? element("ul", { class: "compare-worst" }, ...worst.map(({ decision, k }) => element("li", {}, element("button", {
        type: "button", onclick: () => this.focus(this.lanes.querySelector(`[data-place="${number}-${k}"]`)),
      }, element("bdi", {}, `frame ${decision.frame}: ${action(decision)}, ${percent(decision.regret.lost)} % by ${partWords(decision.regret.cause)}`)),
      " ", element("span", { class: "soft" }, decision.regret.evidence)))) : null)
  }

  pressed(event) {
    if (event.key === "+" || event.key === "-") return this.zoomed(event.key === "+" ? 2 : 0.5)
    const at = event.target.dataset?.place
    if (!at) return
    const [number, k] = at.split("-").map(Number), last = this.episodes[number].decisions.length - 1
    const step = { ArrowRight: k + 1, ArrowLeft: k - 1, Home: 0, End: last }[event.key]
    const other = { ArrowDown: number + 1, ArrowUp: number - 1 }[event.key]
    if (step === undefined && other === undefined) return
    event.preventDefault()
    const place = step === undefined ? `${other}-${this.nearest(other, this.episodes[number].decisions[k].frame)}` : `${number}-${step}`
    this.focus(this.lanes.querySelector(`[data-place="${place}"]`))
  }

  // The decision of an episode that was under way at a frame.
  nearest(number, frame) {
    return Math.max(0, (this.episodes[number]?.decisions ?? []).findLastIndex(decision => decision.frame <= frame))
  }

  focus(bar) {
    if (!bar) return
    for (const other of bar.parentElement.querySelectorAll('.decision[tabindex="0"]')) other.setAttribute("tabindex", -1)
    bar.setAttribute("tabindex", 0)
    bar.focus()
    bar.scrollIntoView({ block: "nearest", inline: "nearest" })
  }

  // Shows a decision in words, and its time in every timeline.
  tell(one, decision = null) {
    const x = decision ? this.x(decision.frame) : -9
    for (const line of this.lanes.querySelectorAll(".cursor")) {
      line.setAttribute("x1", x)
      line.setAttribute("x2", x)
    }
    if (!decision) {
      this.said.replaceChildren(element("span", { class: "soft" }, "Point at a decision, or go to it with the keys, to read about it."))
      return
    }
    const { regret } = decision, share = value => `${percent(value)} %`
    const lines = [
      `${action(decision)}: ${result(decision)}, frames ${decision.frame + decision.waited} to ${decision.frame + decision.waited + decision.frames}`,
      decision.held ? `In the hand: ${decision.held}.` : "", decision.note,
      regret ? `Regret ${share(regret.lost)} of the value${regret.cause ? `, cause: ${partWords(regret.cause)}. ${regret.evidence}` : ""}; the best plan from here reaches ${share(regret.best)}.` : "",
    ]
    this.said.replaceChildren(element("b", {}, named(one.agent, one.person), ` at frame ${decision.frame}, ${share(decision.value)} of the value rescued`),
      ...lines.filter(Boolean).map(line => element("p", {}, element("bdi", {}, line))))
  }
}

function head(one, remove) {
  const link = (address, said) => (address ? element("a", { href: opened(address), target: "_blank", rel: "noopener" }, said) : null)
  const left = one.left_out ? `, ${one.left_out} more decisions are not drawn` : ""
  return element("div", { class: "row compare-head" }, element("h3", {}, named(one.agent, one.person)),
    element("span", { class: "soft" }, element("bdi", {}, `${one.scene}, seed ${one.seed}`), ` · Value ${percent(one.value)} % · `, element("bdi", {}, `ended: ${one.ended}`), ` at frame ${one.frames}${left}`),
    link(one.page_link, "page"), link(one.film_link, "film"),
    element("button", { type: "button", "aria-label": `Remove ${one.agent}, seed ${one.seed}`, onclick: remove }, "Remove"))
}

const key = sign => element("kbd", {}, sign)
const action = decision => `${words(decision.verb)}${decision.target ? ` ${decision.target}` : ""}`
const result = decision => (decision.outcome === "failed" ? `failed (${words(decision.reason)})` : decision.outcome)

function inWords(decision) {
  const lost = decision.regret?.cause ? `; regret ${percent(decision.regret.lost)} % by ${partWords(decision.regret.cause)}` : ""
  return `frame ${decision.frame}: ${action(decision)}, ${result(decision)}, ${decision.frames} frames${lost}${decision.note ? `; ${decision.note}` : ""}`
}
