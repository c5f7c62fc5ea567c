export function mount(element, api) {
  void api
  element.textContent = ""
}
