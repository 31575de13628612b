// What anywidget asks for of every widget here.

/** A state that opens with the widget, and a view of it for every place that shows it. */
const entry = (openState, openView) => () => {
  let state;
  return {
    initialize({ model }) {
      state = openState(model);
      return () => state.close();
    },
    render({ model, el }) {
      const view = openView(model, state, el);
      return () => view.close();
    },
  };
};
