// Requests to the server. The token comes in the address that hazard-ms serve printed, behind the #, which browsers send to
// nobody. It stays in this tab, is sent as a header, never as a cookie, and is worth nothing after the server has ended.

const TOKEN = "hazard_ms token" // in sessionStorage, which belongs to this port alone
let fileKey = ""

// Takes a token out of the address, if there is one. Returns whether there was.
export function takeToken() {
  const found = /^#token=([\w-]+)$/.exec(location.hash)
  if (!found) return false
  sessionStorage.setItem(TOKEN, found[1])
  history.replaceState(null, "", location.pathname)
  return true
}

const token = () => sessionStorage.getItem(TOKEN) || ""

// Shows the server the token, and learns with which key the browser may open files.
export async function enter() {
  fileKey = (await api("/api/enter")).file_key
}

// The address at which the browser can open a file that the server names /files/...
export const opened = address => address.replace(/^\/files\//, `/files/${fileKey}/`)

// A WebSocket, to which the token is shown as the name of a protocol.
export const socket = path => new WebSocket(`ws://${location.host}${path}`, token() ? ["hazard_ms", token()] : ["hazard_ms"])

export async function api(path, options = {}) {
  const { body, ...rest } = options
  const sent = body === undefined ? {} : { method: "POST", body: JSON.stringify(body) }
  const headers = { Authorization: `Bearer ${token()}`, "Content-Type": "application/json" }
  let answer
  try {
    answer = await fetch(path, { credentials: "omit", headers, ...sent, ...rest })
  } catch {
    throw new Error("the server does not answer: has hazard-ms serve ended?")
  }
  const text = await answer.text()
  let content
  try { content = JSON.parse(text) } catch { content = { error: text.trim() } }
  if (!answer.ok) throw new Error(content.error || `the server answered ${answer.status}`)
  return content
}

// An element with properties and children. Text becomes text, never markup.
export function element(name, properties = {}, ...children) {
  const made = document.createElement(name)
  for (const [key, value] of Object.entries(properties)) {
    if (key.startsWith("on")) made.addEventListener(key.slice(2), value)
    else if (key === "class") made.className = value
    else if (key in made && !key.startsWith("aria")) made[key] = value
    else if (value !== null && value !== undefined) made.setAttribute(key, value)
  }
  made.append(...children.filter(child => child !== null && child !== undefined))
  return made
}
