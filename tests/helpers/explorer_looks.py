"""Scripts that measure a page of the explorer: shadow trees included, as a person sees them."""

WALK = """
  const parentOf = (node) => node.assignedSlot ?? node.parentElement
    ?? (node.getRootNode() instanceof ShadowRoot ? node.getRootNode().host : null);
  const chain = (node) => {
    const above = [];
    for (let at = node; at; at = parentOf(at)) above.push(at);
    return above;
  };
  const all = [];
  const walk = (node) => {
    for (const child of node.children) {
      if (child.matches("script, style, link, svg")) continue;
      all.push(child);
      walk(child);
      if (child.shadowRoot) walk(child.shadowRoot);
    }
  };
  walk(document.body);
  const clipped = (node) => chain(node).some((at) => {
    const box = at.getBoundingClientRect();
    return getComputedStyle(at).overflow == "hidden" && (box.width < 2 || box.height < 2);
  });
  const seen = (node) => node.checkVisibility({ opacityProperty: true, visibilityProperty: true })
    && node.getBoundingClientRect().width > 1 && node.getBoundingClientRect().height > 1
    && !clipped(node);
  const textOf = (node) => [...node.childNodes].filter((part) => part.nodeType == 3)
    .map((part) => part.data).join(" ").trim();
  const labelOf = (node) => (node.labels?.[0]?.innerText ?? node.getAttribute("aria-label")
    ?? node.innerText ?? "").trim() || node.className || node.tagName;
  const CONTROLS = 'input:not([type="file"]), select, button:not(.bk-spin-btn), a[href], '
    + 'summary, .bk-tab, [tabindex="0"]';
  const controls = all.filter((node) => node.matches(CONTROLS) && seen(node));
  const isDisabled = (node) => chain(node).some((at) => at.disabled);
"""

LAYOUT = f"""() => {{ {WALK}
  const faults = [];
  const wide = document.documentElement.scrollWidth;
  if (wide > innerWidth) faults.push(`the page is ${{wide}} px wide`);
  for (const node of controls) {{
    const box = node.getBoundingClientRect();
    if (box.left < 0 || box.right > innerWidth) faults.push(`beyond the edge: ${{labelOf(node)}}`);
    if (node.matches("input") && node.scrollWidth > node.clientWidth + 1)
      faults.push(`cut: the value of ${{labelOf(node)}}`);
  }}
  controls.forEach((one, k) => controls.slice(k + 1).forEach((two) => {{
    if (chain(one).includes(two) || chain(two).includes(one)) return;
    const a = one.getBoundingClientRect(), b = two.getBoundingClientRect();
    const width = Math.min(a.right, b.right) - Math.max(a.left, b.left);
    const height = Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top);
    if (width > 1 && height > 1) faults.push(`overlap: ${{labelOf(one)}} and ${{labelOf(two)}}`);
  }}));
  for (const node of all.filter((node) => textOf(node) && seen(node))) {{
    const style = getComputedStyle(node);
    const hides = style.overflowX == "hidden" || style.overflowX == "clip";
    if (hides && node.scrollWidth > node.clientWidth + 1) faults.push(`cut: ${{textOf(node)}}`);
    const range = document.createRange();
    range.selectNodeContents(node);
    const card = chain(node).find((at) => at.matches("section, aside, header"));
    const right = (card ?? document.documentElement).getBoundingClientRect().right;
    if (range.getBoundingClientRect().right > right) faults.push(`too wide: ${{textOf(node)}}`);
  }}
  return faults;
}}"""
"""What is wrong with the layout: a list of texts, empty for nothing."""

CONTRAST = f"""() => {{ {WALK}
  const parse = (colour) => {{
    const [r, g, b, a = 1] = colour.match(/[\\d.]+/g).map(Number);
    return [r, g, b, a];
  }};
  const over = ([r, g, b, a], [R, G, B]) =>
    [r * a + R * (1 - a), g * a + G * (1 - a), b * a + B * (1 - a)];
  const behind = (node) => {{
    const layers = chain(node).map((at) => parse(getComputedStyle(at).backgroundColor));
    return layers.reverse().reduce((below, layer) => over(layer, below), [255, 255, 255]);
  }};
  const luminance = (colour) => {{
    const [r, g, b] = colour.map((part) => part / 255)
      .map((part) => (part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4));
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  }};
  const ratio = (one, two) => {{
    const [low, high] = [luminance(one), luminance(two)].sort((a, b) => a - b);
    return (high + 0.05) / (low + 0.05);
  }};
  const faults = [];
  const note = (what, found, least) => {{
    if (found < least) faults.push(`${{what}}: ${{found.toFixed(2)}} of ${{least}}`);
  }};
  for (const node of all.filter((node) => seen(node) && !isDisabled(node))) {{
    const style = getComputedStyle(node), background = behind(node);
    const field = node.matches("input, select") && node.type != "range";
    if ((textOf(node) || field) && !node.matches(".key")) {{
      const size = parseFloat(style.fontSize);
      const large = size >= 24 || (size >= 18.66 && style.fontWeight >= 700);
      const opacity = chain(node).reduce((p, at) => p * getComputedStyle(at).opacity, 1);
      const [r, g, b, a] = parse(style.color);
      note(textOf(node) || labelOf(node), ratio(over([r, g, b, a * opacity], background),
        background), large ? 3 : 4.5);
    }}
    if (field) note(`edge of ${{labelOf(node)}}`,
      ratio(over(parse(style.borderTopColor), background), behind(parentOf(node))), 3);
  }}
  return faults;
}}"""
"""Contrasts below those of WCAG 2.2, level AA, of texts (1.4.3) and edges of fields (1.4.11)."""

FOCUSED = f"""() => {{ {WALK}
  let node = document.activeElement;
  while (node?.shadowRoot?.activeElement) node = node.shadowRoot.activeElement;
  if (!node || node === document.body) return null;
  const style = getComputedStyle(node);
  const ring = style.outlineStyle != "none" && parseFloat(style.outlineWidth) > 0;
  const box = node.getBoundingClientRect();
  return {{
    label: labelOf(node), ring: ring || style.boxShadow != "none", x: box.left, y: box.top,
    kind: node.tagName,
  }};
}}"""
"""The focused control: its label, its place, and whether one sees that it has the focus."""
