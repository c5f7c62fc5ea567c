// One rescue on the page: its pictures, what can be chosen, what has been decided. Shared by Play and Watch.

import { element, opened, socket } from "./api.js"

const PICTURES = { r: "third person", h: "head camera", z: "hazard", m: "map of what the robot has seen" }
const NOTHING = "data:image/gif;base64,R0lGODlhAQABAIAAAAAAAP///yH5BAEAAAAALAAAAAABAAEAAAIBRAA7" // one clear pixel
const RETRY = 1500 // time between two tries to reach the server [ms]

export class Rescue {
  // `report` is called with every message, after it has been shown
  constructor(name, api, report = () => {}) {
    Object.assign(this, { name, api, report, rows: [], state: null, begun: null, ended: false })
    this.build()
    this.connect()
  }

  build() {
    this.pictures = {}
    const figures = Object.entries(PICTURES).map(([key, title]) => {
      const image = element("img", { alt: `Picture: ${title}`, src: NOTHING, draggable: false })
      this.pictures[key] = image
      if (key !== "z") image.addEventListener("click", event => this.point(key, event))
      return element("figure", { class: `picture picture-${key}` }, image, element("figcaption", {}, title))
    })
    this.title = element("h2", { class: "title" }, "Setting up the rescue …")
    this.text = element("p", { class: "soft" })
    this.clock = element("b", { class: "large" }, "–")
    this.value = element("b", { class: "large" }, "–")
    this.meter = element("progress", { max: 1, value: 0, "aria-label": "Frames that have passed" })
    this.held = element("span", {})
    this.averted = element("b", { class: "large" }, "–")
    this.avertedCard = element("div", { class: "card averted", hidden: true }, this.averted, "averted: of what would be lost if nobody acted")
    this.doors = element("ul", { class: "targets doors", "aria-label": "Doors and tools" })
    this.targets = element("ul", { class: "targets", "aria-label": "Things to rescue" })
    this.now = element("p", { class: "now", role: "status", "aria-live": "polite" })
    this.note = element("p", { class: "soft note" })
    this.choices = element("ol", { class: "choices", "aria-label": "What the robot can do now" })
    this.things = element("select", { "aria-label": "A thing", onchange: () => this.about(this.things.value) })
    this.menu = element("div", { class: "menu", role: "group", "aria-label": "What can be done with the thing", "aria-live": "polite" })
    this.log = element("tbody")
    this.banner = element("div", { class: "banner", role: "alert", hidden: true })
    this.files = element("div", { class: "files", "aria-live": "polite" })
    this.buttons = element("div", { class: "row" })
    this.asking = element("div", { class: "card ask" }, element("h3", {}, "What shall the robot do?"), this.choices,
      element("h3", {}, "Or with a thing, chosen here or clicked in a picture"), this.things, this.menu)
    const head = ["#", "frame", "action", "how it went", "reason"].map((text, at) => element("th", { scope: "col", class: at < 2 ? "n" : "" }, text))
    this.root = element("section", { class: "rescue", "aria-label": "A rescue" },
      this.banner, this.title, this.text,
      element("div", { class: "stage" },
        element("div", { class: "views" }, ...figures),
        element("div", { class: "side" },
          element("div", { class: "cards" },
            element("div", { class: "card" }, this.value, "value rescued"),
            element("div", { class: "card" }, this.clock, this.meter), this.avertedCard),
          this.targets, this.doors, element("p", {}, this.held), this.now, this.note, this.buttons, this.asking, this.files)),
      element("details", { open: true }, element("summary", {}, "Decisions"),
        element("div", { class: "wide", tabIndex: 0, role: "region", "aria-label": "Decisions" },
          element("table", {}, element("thead", {}, element("tr", {}, ...head)), this.log))))
  }

  connect() {
    if (this.ended) return
    this.socket = socket(`/api/rescues/${this.name}/live`)
    this.socket.binaryType = "blob"
    this.socket.addEventListener("open", () => this.on_again()) // the server tells everything from the beginning
    this.socket.addEventListener("message", event => {
      if (typeof event.data === "string") this.heard(JSON.parse(event.data))
      else this.show(event.data)
    })
    this.socket.addEventListener("close", () => {
      if (this.ended) return
      this.say("The server does not answer: it has stopped or was killed. To continue, start hazard-ms serve with the same folder and open the address it prints.", true)
      this.timer = setTimeout(() => this.connect(), RETRY)
    })
  }

  ask(message) {
    if (this.socket.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(message))
  }

  leave() {
    this.ended = true
    clearTimeout(this.timer)
    this.socket.close()
    this.root.remove()
  }

  say(text, bad, ...more) {
    this.banner.hidden = !text
    this.banner.className = bad ? "banner bad" : "banner"
    this.banner.replaceChildren(text, ...more)
  }

  async show(data) {
    const key = await data.slice(0, 1).text()
    const image = this.pictures[key]
    if (!image) return
    const address = URL.createObjectURL(data.slice(1, data.size, "image/jpeg"))
    const old = image.src
    image.src = address
    image.closest("figure").classList.add("seen")
    if (old) URL.revokeObjectURL(old)
    this.shown = (this.shown || 0) + (key === "r" || (key === "h" && this.begun && !this.begun.room))
  }

  heard(message) {
    const deal = this[`on_${message.type}`]
    if (deal) deal.call(this, message)
    this.report(message, this)
  }

  on_building() { this.now.textContent = "Building the scene; the first takes about half a minute." }

  on_again() {
    this.rows = []
    this.state = null
    this.asking.hidden = true
    this.log.replaceChildren()
    this.files.replaceChildren()
    this.say("", false)
  }

  on_begun(message) {
    this.begun = message
    this.title.textContent = `${message.task}, ${message.scene}, seed ${message.seed}: ${message.agent}`
    this.text.textContent = message.text
    this.root.classList.toggle("narrow", !message.room)
    this.root.classList.remove("over")
    for (const key of message.drawn === false ? "" : message.room ? "rhm" : "hm") this.pictures[key].closest("figure").classList.add("seen") // a place for what comes
  }

  on_replaying(message) {
    this.now.textContent = `Simulating the decisions so far again: ${message.done} of ${message.of}.`
  }

  on_tick(message) {
    const { max_frames: most, frame_seconds: seconds } = this.begun || { max_frames: 1, frame_seconds: 0 }
    this.clock.textContent = `${message.frame} of ${most}`
    this.clock.title = seconds ? `${(message.frame * seconds).toFixed(1)} s` : ""
    this.meter.value = message.frame / most
    this.value.textContent = `${Math.round(100 * message.value)} %`
    this.held.textContent = message.held ? `In the hand: ${message.held}` : "The hand is empty."
  }

  on_state(message) {
    this.state = message
    this.on_tick(message)
    const worth = Math.max(...message.targets.map(target => target.value)) > 5 ? 10 : 5 // as on the map
    this.targets.replaceChildren(...message.targets.map(target => {
      const how = target.rescued ? (target.damaged ? "rescued, damaged" : "rescued") : target.held ? "in the hand" : target.damaged ? "damaged" : target.seen ? "seen" : "not seen yet"
      const kind = target.rescued ? "is-rescued" : target.damaged ? "is-damaged" : target.held ? "is-held" : ""
      return element("li", { class: `${kind} ${target.value >= worth ? "is-worth" : ""}` }, `${target.name} (${target.value}): ${how}`)
    }))
    const doors = (message.doors || []).map(door => {
      const how = door.broken ? "gone" : door.open < 0.1 ? "shut" : door.open > 0.9 ? "open" : "ajar"
      return this.chip(door.name, how, how === "shut" ? "is-shut" : door.broken ? "is-damaged" : "")
    })
    const tools = (message.tools || []).map(tool => this.chip(tool.name, `${Math.round(100 * tool.left)} % left`, tool.held ? "is-held" : ""))
    this.doors.replaceChildren(...doors, ...tools)
    if (doors.length) this.pictures.m.closest("figure").querySelector("figcaption").textContent = `${PICTURES.m}: squares are doors, filled while shut, red bars are extinguishers`
    const words = { asking: "It is your turn.", doing: `The robot is busy: ${message.intent}.`, thinking: "The agent is thinking.",
      paused: `Paused. The agent would: ${message.intent}.`, over: `The rescue is over: ${message.ended}.` }
    const last = message.last && !message.last.ok ? `${message.last.action} was not done: ${message.last.reason.replaceAll("_", " ")}. ` : ""
    this.now.textContent = last + (words[message.phase] || "")
    this.note.textContent = message.note || ""
    this.asking.hidden = message.phase !== "asking"
    this.choices.replaceChildren(...message.choices.map((choice, at) => element("li", {}, this.button(choice, at))))
    const same = message.things.includes(this.things.value) ? this.things.value : ""
    this.things.replaceChildren(element("option", { value: "" }, "choose a thing"), ...message.things.map(name => element("option", { value: name }, name)))
    this.things.value = same
    this.menu.replaceChildren()
  }

  chip(name, how, kind) { // of a door or a tool; a click tells what can be done with it
    return element("li", { class: kind }, element("button", { class: "chip", onclick: () => this.about(name) }, `${name}: ${how}`))
  }

  button(choice, at) {
    const key = at < 9 ? element("kbd", {}, String(at + 1)) : null
    return element("button", { onclick: () => this.choose(choice.key), "data-key": choice.key }, key, key ? " " : null, choice.words)
  }

  choose(key) {
    if (!this.state || this.state.phase !== "asking") return
    this.ask({ do: "choose", number: this.state.number, key })
    this.able(false)
  }

  able(yes) { for (const button of this.asking.querySelectorAll("button")) button.disabled = !yes }

  number(digit) { // the choice of a number key: of the menu of a thing if that is open, else of all
    const open = this.menu.querySelectorAll("button")
    const buttons = open.length ? open : this.choices.querySelectorAll("button")
    if (buttons[digit - 1]) buttons[digit - 1].click()
  }

  point(picture, event) {
    const box = event.currentTarget.getBoundingClientRect()
    this.ask({ do: "point", picture, across: (event.clientX - box.left) / box.width, down: (event.clientY - box.top) / box.height })
  }

  about(name) {
    if (name) this.ask({ do: "thing", name })
    else this.menu.replaceChildren()
  }

  on_pointed(message) {
    const title = element("p", {}, message.name ? `${message.name}${message.why ? `: ${message.why}` : ""}` : message.why)
    this.menu.replaceChildren(title, ...message.choices.map((choice, at) => this.button(choice, at)))
    if (message.name && [...this.things.options].some(option => option.value === message.name)) this.things.value = message.name
    if (message.choices.length) this.menu.querySelector("button").focus()
  }

  on_refused(message) {
    this.now.textContent = message.why
    this.able(true)
  }

  on_row(message) {
    const { number } = message
    this.rows[number] = message
    const what = message.target ? `${message.verb.replaceAll("_", " ")} ${message.target}` : message.verb.replaceAll("_", " ")
    const how = message.ok ? "done" : message.unfinished ? "unfinished" : message.reason.replaceAll("_", " ")
    const made = element("tr", { "data-number": number }, element("td", { class: "n" }, this.jump ? this.jump(number) : String(number)),
      element("td", { class: "n" }, String(message.frame)), element("td", {}, what),
      element("td", { class: message.ok ? "good" : message.unfinished ? "soft" : "bad" }, how), element("td", { class: "soft why" }, message.note || ""))
    const old = this.log.querySelector(`[data-number="${number}"]`)
    if (old) old.replaceWith(made)
    else this.log.append(made)
  }

  on_over(message) {
    this.now.textContent = message.summary || `The rescue is over: ${message.ended}.`
    this.asking.hidden = true
    this.root.classList.add("over")
    if (message.files) this.link(message.files)
  }

  on_averted(message) {
    this.averted.textContent = `${Math.round(100 * message.share)} %`
    this.avertedCard.hidden = false
  }

  on_filming(message) { this.progress(`Making the film by simulating the rescue again: frame ${message.frame} of ${message.of}.`) }

  on_kept(message) {
    this.link(message.files)
    this.progress(`Simulated again, the rescue is: ${message.replay}.${message.demonstration ? ` A demonstration is in ${message.demonstration}.` : ""}`)
    this.done = true
  }

  link(files) {
    const links = files.map(file => element("li", {}, element("a", { href: opened(file.address), target: "_blank", rel: "noopener" }, file.name)))
    this.files.replaceChildren(element("h3", {}, files.length ? "Files of this rescue" : ""), element("ul", {}, ...links), element("p", { class: "soft film" }))
  }

  progress(text) {
    const line = this.files.querySelector(".film")
    if (line) line.textContent = text
  }

  on_died(message) {
    this.say(`The rescue's process ended: ${message.why}. `, true,
      element("button", { onclick: () => this.again() }, "Go on with the decisions so far"))
  }

  on_failed(message) {
    this.say(`The rescue cannot continue: ${message.why}. `, true,
      element("button", { onclick: () => this.again() }, "Try again with the decisions so far"))
  }

  on_gone(message) {
    this.say(`This rescue cannot be resumed: ${message.why}.`, true)
    this.ended = true
  }

  on_closed() {
    if (this.done || this.ended) return
    this.say("This rescue was ended.", false)
    this.ended = true
  }

  async again() {
    this.say("", false)
    try { await this.api(`/api/rescues/${this.name}/again`, { body: {} }) } catch (error) { this.say(error.message, true) }
  }
}
