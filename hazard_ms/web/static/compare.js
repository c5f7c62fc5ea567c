// Results of folders beside one another.

export function mount(element, api) {
  void api
  element.textContent = ""
}
