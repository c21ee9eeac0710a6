// Keys: on the map, arrows and Enter go to the data named "keys", which the server follows.
const STEPS = {
  ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1], Enter: [0, 0],
};
const CANVAS = ".bk-layer.bk-events";
const SKIPPED = `.bk-spin-btn, ${CANVAS}, .filepond--browser`;
const view = document.querySelector(".view");
let presses = 0;

view.addEventListener("focusin", (event) => {
  const [focused] = event.composedPath();
  if (focused.matches(CANVAS)) focused.style.outline = "none";
});
view.addEventListener("keydown", (event) => {
  const step = STEPS[event.key];
  const [focused] = event.composedPath();
  const onMap = focused === event.currentTarget || focused.matches(CANVAS);
  if (!step || !onMap || event.ctrlKey || event.altKey) return;
  const [keys] = Bokeh.documents.map((page) => page.get_model_by_name("keys")).filter(Boolean);
  if (!keys) return;
  event.preventDefault();
  presses += 1;
  keys.data = { right: [step[0]], up: [step[1]], count: [presses] };
});

// Flights: the 3D view asks for them when it is ready, and gets every change that follows.
let space = null;
const named = (name) =>
  Bokeh.documents.map((page) => page.get_model_by_name(name)).find(Boolean)?.data;
const contents = {
  "flight lines": ({ x, y, colour }) => ({
    lines: x.map((at, k) => ({ x: Array.from(at), y: Array.from(y[k]), colour: colour[k] })),
  }),
  "flight steps": ({ step }) => ({ steps: Array.from(step) }),
  "flight belief": ({ probability: [cells], columns: [columns], darkest: [darkest] }) => ({
    belief: cells ? { cells: Float32Array.from(cells), columns, darkest } : {},
  }),
};
window.passOnFlights = (name) => {
  const data = named(name);
  if (space && data) space.postMessage(contents[name](data), "*");
};
window.addEventListener("message", (event) => {
  if (event.data !== "flights?") return;
  space = event.source;
  Object.keys(contents).forEach(window.passOnFlights);
});

// The library puts tabs behind their content, and makes a stop of each arrow of a number.
const tidy = (root) => {
  for (const node of root.querySelectorAll("*")) {
    if (node.matches(SKIPPED)) node.tabIndex = -1;
    if (node.title && node.tabIndex === 0) node.ariaLabel ??= node.title;
    if (node.matches(".bk-header") && root.firstElementChild !== node) root.prepend(node);
    if (node.shadowRoot) tidy(node.shadowRoot);
  }
};
document.addEventListener("keydown", (event) => {
  if (event.key === "Tab") tidy(document);
  const [focused] = event.composedPath();
  if ([" ", "Enter"].includes(event.key) && focused.matches?.(".bk-tab")) {
    event.preventDefault();
    focused.click();
  }
}, true);
