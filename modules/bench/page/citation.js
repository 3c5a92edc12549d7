// Figures that leave the page take along where they come from: whatever is copied ends with a citation line.

const versions = [...new Set(results.runs.map((run) => run.cost?.version).filter((text) => text))];
const seeds = [...new Set(results.runs.map((run) => run.seed).filter((seed) => seed))];

/// What this report is, in one line.
const citationLine = [
  `${results.title} (${results.matrix})`,
  versions.length ? `Holdfast ${versions.join(' and ')}` : null,
  `${counted(results.runs.filter((run) => run.counts).length, 'run')}, ${counted(results.sequences.length, 'sequence')}`,
  seeds.length ? `${seeds.length === 1 ? 'seed' : 'seeds'} ${seeds.join(', ')}` : null,
  'SE(3) alignment, RPE over 1 s',
].filter((part) => part).join('; ');

/// The citation of a place in the page: that of the nearest element with one (a published row), or of the report.
const citationOf = (node) => {
  const place = node.nodeType === Node.ELEMENT_NODE ? node : node.parentElement;
  return place?.closest('[data-citation]')?.dataset.citation ?? citationLine;
};

const withCitation = (text, citation) => `${text.replace(/\s+$/, '')}\n${citation}\n`;

/// Copies text by a selection, which works for a page from a file in every browser.
function copyText(text) {
  const area = element('textarea', {style: 'position: fixed; opacity: 0'});
  area.value = text;
  document.body.append(area);
  area.select();
  area.dataset.verbatim = 'yes';
  document.execCommand('copy');
  area.remove();
}

/// A button that copies what a function gives, and says so.
function copyButton(label, textOf) {
  const button = element('button', {type: 'button', class: 'copy'}, label);
  button.addEventListener('click', () => {
    copyText(textOf());
    button.textContent = 'Copied';
    setTimeout(() => (button.textContent = label), 1500);
  });
  return button;
}

/// The rows of a table as text with tabs, numbers as they are shown.
function tableText(table) {
  const cellText = (cell) => [...cell.childNodes].map((node) => node.textContent).join(' ').replace(/\s+/g, ' ').trim();
  const citations = new Set();
  const lines = [...table.querySelectorAll('tr')].map((row) => {
    citations.add(citationOf(row));
    return [...row.cells].map(cellText).join('\t');
  });
  return withCitation(lines.join('\n'), [...citations].join('\n'));
}

document.addEventListener('copy', (event) => {
  if (document.activeElement?.dataset.verbatim) return;
  const selection = getSelection();
  if (selection.isCollapsed || !byId('content').contains(selection.anchorNode)) return;
  const rows = [...document.querySelectorAll('[data-citation]')].filter((row) => selection.containsNode(row, true));
  const inside = [...new Set(rows.map((row) => row.dataset.citation))];
  event.clipboardData.setData('text/plain', withCitation(selection.toString(), inside.length ? inside.join('\n') : citationOf(selection.anchorNode)));
  event.preventDefault();
});
