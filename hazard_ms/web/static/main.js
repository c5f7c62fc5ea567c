// The page: three tabs, each filled by a module of its own when it is first shown.

import { api } from "./api.js"

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
  history.replaceState(null, "", `${location.pathname}#${name}`) // the token leaves the address
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
const wanted = location.hash.slice(1)
show(PARTS.includes(wanted) ? wanted : "play")
