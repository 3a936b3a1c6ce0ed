// What the tests ask of a page.

// Pairs of texts that lie on one another, as seen: what is clipped or hidden does not count.
const overlaps = () => {
  const texts = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  const seen = [];
  while (texts.nextNode()) {
    const { data, parentElement: owner } = texts.currentNode;
    if (!data.trim() || owner.closest("script, style, .modebar, .print, .skip")) continue;
    if (!owner.checkVisibility({ visibilityProperty: true, opacityProperty: true })) continue;
    const clips = [];
    for (let e = owner; e; e = e.parentElement) {
      if (/auto|hidden|scroll/.test(getComputedStyle(e).overflow)) clips.push(e.getBoundingClientRect());
    }
    const range = document.createRange();
    range.selectNodeContents(texts.currentNode);
    for (const box of range.getClientRects()) {
      const left = Math.max(box.left, ...clips.map((clip) => clip.left));
      const top = Math.max(box.top, ...clips.map((clip) => clip.top));
      const right = Math.min(box.right, ...clips.map((clip) => clip.right));
      const bottom = Math.min(box.bottom, ...clips.map((clip) => clip.bottom));
      if (right - left > 1 && bottom - top > 1) seen.push({ left, top, right, bottom, data: data.trim().slice(0, 40) });
    }
  }
  seen.sort((a, b) => a.top - b.top);
  const pairs = [];
  for (const [i, a] of seen.entries()) {
    for (const b of seen.slice(i + 1)) {
      if (b.top >= a.bottom) break;
      const across = Math.min(a.right, b.right) - Math.max(a.left, b.left);
      const down = Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top);
      if (across > 2 && down > 4) pairs.push([a.data, b.data, across, down]);
    }
  }
  return pairs;
};

// Texts of figures under their buttons.
const covered = () => [...document.querySelectorAll(".plot")].flatMap((plot) => {
  const buttons = [...plot.querySelectorAll(".modebar-btn")].map((e) => e.getBoundingClientRect());
  const under = (box) => buttons.some((b) => b.left < box.right && box.left < b.right && b.top + 2 < box.bottom && box.top < b.bottom - 2);
  return [...plot.querySelectorAll("text")].filter((e) => under(e.getBoundingClientRect())).map((e) => e.textContent);
});

// Texts of figures that the edge of their figure cuts.
const cut = () => [...document.querySelectorAll(".plot")].flatMap((plot) => {
  const edge = plot.getBoundingClientRect();
  const out = (box) => box.width > 0 && (box.left < edge.left - 1 || box.right > edge.right + 1);
  return [...plot.querySelectorAll("text")].filter((e) => out(e.getBoundingClientRect())).map((e) => e.textContent);
});

// How many points, lines and bars with something in them a figure shows.
const marks = (plot) => {
  const drawn = document.getElementById(plot).querySelectorAll(
    ".scatterlayer .point, .scatterlayer path.js-line, .barlayer .point path");
  return [...drawn].filter((mark) => (mark.getAttribute("d") ?? "").length > 4).length;
};

const lightness = (colour) => colour.match(/[\d.]+/g).slice(0, 3).reduce((sum, part) => sum + part / 765, 0);

// How light the paper and the label of a figure are, from 0 to 1.
const light = () => {
  const label = document.querySelector("#return_errors-0 .xtick text");
  return [getComputedStyle(document.body).backgroundColor, getComputedStyle(label).fill].map(lightness);
};

// Drawings for paper that are seen, figures, what has no place on paper, and how light the paper is.
const onPaper = () => {
  const all = (what) => [...document.querySelectorAll(what)];
  const drawings = all(".print svg").filter((e) => e.checkVisibility() && e.getBoundingClientRect().height > 50);
  const others = all(".plot, .tools, nav").filter((e) => e.checkVisibility());
  const paper = lightness(getComputedStyle(document.body).backgroundColor);
  return [drawings.length, all("figure").length, others.length, paper];
};

// Figures with words for a screen reader, with a table, in all; headings that skip a level; links with and without a target.
const toRead = () => {
  const all = (what) => [...document.querySelectorAll(what)];
  const named = all("[role=img].plot").filter((e) => e.ariaLabel.length > 20);
  const tables = all("figure").filter((e) => e.querySelector("details table"));
  const levels = all("h1, h2, h3, h4").map((heading) => Number(heading.tagName[1]));
  const jumps = levels.filter((level, i) => i > 0 && level > levels[i - 1] + 1);
  const lost = all("nav a").filter((link) => !document.querySelector(link.hash));
  return [named.length, tables.length, all("figure").length, jumps.length, lost.length];
};
