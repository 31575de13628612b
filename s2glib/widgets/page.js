// The page that plays without a kernel: the same player on a model that only lives here.

class LocalModel {
  constructor(state) {
    this.state = state;
    this.listeners = [];
  }
  get(name) {
    return this.state[name];
  }
  set(name, value) {
    if (this.state[name] === value) return;
    this.state[name] = value;
    for (const [event, act] of [...this.listeners]) if (event === `change:${name}`) act();
  }
  on(event, act) {
    this.listeners.push([event, act]);
  }
  off(event, act) {
    this.listeners = this.listeners.filter(([e, a]) => e !== event || a !== act);
  }
  save_changes() {}
}

/** Buttons that show one motion alone, or all of them side by side. */
function addChoices(model, names, host) {
  const choices = [...names.map((name) => [name, name]), ["", "side by side"]];
  const buttons = choices.map(([view, text]) => {
    const button = element("button", { type: "button", "aria-pressed": view === model.get("view") }, text);
    button.onclick = () => {
      model.set("view", view);
      for (const other of buttons) other.setAttribute("aria-pressed", other === button);
    };
    return button;
  });
  host.append(...buttons);
}

function openPage() {
  const content = JSON.parse(document.getElementById("content").textContent);
  const bytes = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  for (const name of ["mesh", "motion", "sound"]) content[name] = bytes(content[name]);
  const start = { frame: [0, 0], playing: [0, false] };
  const model = new LocalModel({ ...content, order: start, heard: start });
  const { names } = unpack(content.motion);
  if (names.length > 1) addChoices(model, names, document.getElementById("choices"));
  const player = createPlayer();
  player.initialize({ model });
  player.render({ model, el: document.getElementById("player") });
}

openPage();
