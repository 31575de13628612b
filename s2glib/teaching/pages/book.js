// The players of a page: what the notebook kept, on the one body that all of them share. Each opens
// when it comes near, because a browser draws few of them at once.

function openPlace(place) {
  const kept = JSON.parse(place.querySelector("script").textContent);
  place.replaceChildren();
  if (kept.film) openFilm(kept, place);
  else openPlayer({ ...kept, mesh: window.mannequin }, place);
}

const near = new IntersectionObserver((entries) => {
  for (const { isIntersecting, target } of entries) {
    if (!isIntersecting) continue;
    near.unobserve(target);
    openPlace(target);
  }
}, { rootMargin: "50%" });
for (const place of document.querySelectorAll(".place")) near.observe(place);
