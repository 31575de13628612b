// The page of write_html: one player, of the content that stands in the page.

openPlayer(
  JSON.parse(document.getElementById("content").textContent),
  document.getElementById("choices"),
  document.getElementById("player"),
);
