"""Automatic accessibility audit of a page: rules of WCAG 2.1 level AA that a program can check.

If axe-core is installed (npm install --global axe-core, or AXE with the path of axe.min.js), its rules
are checked, too.
"""

import os
import pathlib

RULES = r"""
const shown = (node) => node.checkVisibility({ checkOpacity: true, checkVisibilityCSS: true });
const all = (selector) => Array.from(document.querySelectorAll(selector)).filter(shown);
const problems = [];
const add = (rule, node, what = "") => problems.push(rule + ": " + what + " " + node.outerHTML.slice(0, 160));

// Names of controls and frames (1.1.1, 1.3.1, 2.4.1, 4.1.2). `arguments[0]` names them by their number.
const controls = "a[href], button, input:not([type=hidden]), select, textarea, iframe, summary, [tabindex='0'], [role=radiogroup]";
all(controls).forEach((node) => {
  const ids = (node.getAttribute("aria-labelledby") || "").split(" ").filter(Boolean);
  const labels = [...(node.labels || [])].map((one) => one.textContent);
  const texts = [node.getAttribute("aria-label"), ...ids.map((id) => (document.getElementById(id) || {}).textContent),
    ...labels, node.title, ["A", "BUTTON", "SUMMARY"].includes(node.tagName) ? node.textContent : ""];
  if (!texts.some((text) => text && text.trim())) add("name", node);
  const visible = node.textContent.trim(), name = node.getAttribute("aria-label");
  const shown_name = (["A", "BUTTON"].includes(node.tagName) ? visible : labels.map((label) => label.trim()).join(" "));
  if (name && shown_name && !name.toLowerCase().includes(shown_name.toLowerCase())) {
    add("label in name", node, shown_name);  // 2.5.3
  }
  for (const attribute of ["aria-labelledby", "aria-describedby", "aria-controls"]) {
    for (const id of (node.getAttribute(attribute) || "").split(" ").filter(Boolean)) {
      if (!document.getElementById(id)) add("reference", node, id);
    }
  }
});

// Identifiers, language, title, landmarks and headings (2.4.2, 2.4.6, 3.1.1, 1.3.1).
const ids = [...document.querySelectorAll("[id]")].map((node) => node.id);
ids.filter((id, i) => ids.indexOf(id) !== i).forEach((id) => problems.push("id is repeated: " + id));
if (!document.documentElement.lang) problems.push("language is missing");
if (!document.title) problems.push("title is missing");
for (const selector of ["main", "h1"]) if (all(selector).length !== 1) problems.push("not one " + selector);
if (!all("nav[aria-label]").length) problems.push("no named nav");
let level = 0;
all("h1, h2, h3, h4").forEach((node) => {
  const next = Number(node.tagName[1]);
  if (next > level + 1) add("heading order", node);
  level = next;
});
all("table").forEach((table) => { if (!table.querySelector("th[scope]")) add("table header", table); });
all("[role=group], fieldset").forEach((node) => {
  if (node.tagName === "FIELDSET" && !(node.querySelector("legend") || {}).textContent) add("legend", node);
});

// Contrast of texts and of the borders of fields (1.4.3, 1.4.11).
const parse = (colour) => (colour.match(/[\d.]+/g) || []).map(Number);
const light = ([r, g, b]) => [r, g, b].map((value) => value / 255)
  .map((value) => (value <= 0.04045 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4))
  .reduce((sum, value, i) => sum + value * [0.2126, 0.7152, 0.0722][i], 0);
const ratio = (a, b) => (Math.max(light(a), light(b)) + 0.05) / (Math.min(light(a), light(b)) + 0.05);
function ground(node) {
  for (; node; node = node.parentElement) {
    const colour = parse(getComputedStyle(node).backgroundColor);
    if (colour.length === 3 || colour[3] === 1) return colour;
    if (colour[3] > 0) return null;  // no rule for mixed colours
  }
  return [255, 255, 255];
}
let least = Infinity, texts = 0;
const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
for (let text = walker.nextNode(); text; text = walker.nextNode()) {
  const node = text.parentElement;
  if (!text.data.trim() || !shown(node) || ["SCRIPT", "STYLE", "NOSCRIPT", "OPTION"].includes(node.tagName)) continue;
  if (node.closest(":disabled") || node.closest(".skip")) continue;
  const style = getComputedStyle(node), below = ground(node), size = parseFloat(style.fontSize);
  const needed = size >= 24 || (size >= 18.66 && Number(style.fontWeight) >= 700) ? 3 : 4.5;
  if (!below) { add("mixed background", node); continue; }
  const found = ratio(parse(style.color), below);
  least = Math.min(least, found);
  ++texts;
  if (found < needed) add("contrast", node, found.toFixed(2));
}
all("input:not([type=radio]):not([type=checkbox]):not([type=file]), select, textarea").forEach((node) => {
  const found = ratio(parse(getComputedStyle(node).borderTopColor), ground(node.parentElement));
  if (found < 3) add("border contrast", node, found.toFixed(2));
});

// Target size (2.5.8 of WCAG 2.2) and focus order (2.4.3).
all("button, select, input, summary, a.button").forEach((node) => {
  const box = (node.labels && node.labels.length && ["radio", "checkbox"].includes(node.type) ? node.labels[0] : node).getBoundingClientRect();
  if (box.width < 24 || box.height < 24) add("target size", node, Math.round(box.width) + " x " + Math.round(box.height));
});
document.querySelectorAll("[tabindex]").forEach((node) => { if (Number(node.getAttribute("tabindex")) > 0) add("tabindex", node); });
return { problems, texts, least };
"""

AXE = next((path for path in (os.environ.get("AXE", ""), "/usr/share/nodejs/axe-core/axe.min.js",
                              "/usr/local/lib/node_modules/axe-core/axe.min.js",
                              "/usr/lib/node_modules/axe-core/axe.min.js") if path and os.path.exists(path)), None)


def audit(test, browser, what):
    """Fails if the visible part of the page violates a rule. Returns the number of checked texts."""
    found = browser.execute_script(RULES)
    test.assertEqual(found["problems"], [], what)
    test.assertGreater(found["texts"], 5, what)
    test.assertGreaterEqual(found["least"], 4.5, what)
    if AXE:
        browser.execute_script(pathlib.Path(AXE).read_text() + "\nwindow.axe = axe;")
        violations = browser.execute_async_script("""
            const done = arguments[0];
            axe.run({ iframes: false, runOnly: ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa"] }).then(
                ({ violations }) => done(violations.map(({ id, nodes }) =>
                    id + ": " + nodes.slice(0, 3).map((node) => node.html.slice(0, 160)).join(" | "))),
                (failure) => done([String(failure)]));""")
        test.assertEqual(violations, [], what + " (axe-core)")
    return found["texts"]
