// A question: its answers as buttons, and below them what is said of the one chosen last.

/** A new element with attributes, and children inside it. */
function element(tag, attributes, ...children) {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
  node.append(...children);
  return node;
}

function render({ model, el }) {
  const answers = model.get("answers");
  const choose = (place) => {
    model.set("chosen", place);
    model.save_changes();
  };
  const buttons = answers.map(({ text }, place) => {
    const button = element("button", { type: "button" }, text);
    button.onclick = () => choose(place);
    return button;
  });
  const verdict = element("p", { role: "status", "aria-live": "polite" });
  const show = () => {
    const chosen = model.get("chosen");
    buttons.forEach((button, place) => button.setAttribute("aria-pressed", place === chosen));
    verdict.textContent = answers[chosen]?.verdict ?? "";
  };
  const group = element("fieldset", {}, element("legend", {}, model.get("text")), ...buttons);
  // Lab would take the Enter key for itself.
  el.append(element("div", { class: "s2g-question", "data-lm-suppress-shortcuts": "true" }, group, verdict));
  model.on("change:chosen", show);
  show();
  return () => model.off("change:chosen", show);
}

export default { render };
