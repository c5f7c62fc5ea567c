// The page: three tabs, each filled by a module of its own when it is first shown.

import { api, element, enter, takeToken } from "./api.js"

const PARTS = ["play", "watch", "compare"]
const mounted = new Set()

async function show(name, focus = false) {
  for (const part of PARTS) {
    const chosen = part === name, tab = document.getElementById(`tab-${part}`)
    document.getElementById(part).hidden = !chosen
    tab.setAttribute("aria-selected", String(chosen))
    tab.tabIndex = chosen ? 0 : -1
    if (chosen && focus) tab.focus()
  }
  history.replaceState(null, "", `${location.pathname}#${name}`)
  if (mounted.has(name)) return
  mounted.add(name)
  const part = await import(`./${name}.js`)
  part.mount(document.getElementById(name), api)
}

for (const [number, part] of PARTS.entries()) {
  const tab = document.getElementById(`tab-${part}`)
  tab.addEventListener("click", () => show(part))
  tab.addEventListener("keydown", event => {
    const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key]
    if (step) show(PARTS[(number + step + PARTS.length) % PARTS.length], true)
  })
}
async function start() {
  try {
    await enter()
  } catch (error) {
    const why = element("div", { class: "banner bad", role: "alert" }, `${error.message}. Open the address that hazard-ms serve printed when it was started last.`)
    document.querySelector(".tabs").hidden = true
    document.getElementById("main").replaceChildren(why)
    return
  }
  const wanted = location.hash.slice(1)
  await show(PARTS.includes(wanted) ? wanted : "play")
}

addEventListener("hashchange", () => { if (takeToken()) location.reload() }) // another address was opened in this tab
takeToken()
void start()
