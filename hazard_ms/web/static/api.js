// Requests to the server; the cookie that the first page has set holds the token.

export async function api(path, options = {}) {
  const { body, ...rest } = options
  const sent = body === undefined ? {} : { method: "POST", body: JSON.stringify(body), headers: { "Content-Type": "application/json" } }
  let answer
  try {
    answer = await fetch(path, { credentials: "same-origin", ...sent, ...rest })
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
