// What all parts of the page share: the data, how numbers are written, how elements are made, which colour a run has.

const results = JSON.parse(document.getElementById('results-data').textContent);
const tracks = JSON.parse(document.getElementById('tracks-data').textContent);

const quantities = {
  ate_m: {name: 'ATE', unit: 'm'},
  rpe_translation_m: {name: 'RPE translation', unit: 'm/s'},
  rpe_rotation_deg: {name: 'RPE rotation', unit: 'deg/s'},
};
const statistics = {rmse: 'RMSE', mean: 'mean', median: 'median', standard_deviation: 'S.D.', min: 'min', max: 'max'};

const isNumber = (value) => typeof value === 'number' && Number.isFinite(value);
const fixed = (value, decimals) => (isNumber(value) ? value.toFixed(decimals).replace('-', '−') : '–');
const percent = (share, decimals = 1) => (isNumber(share) ? `${fixed(100 * share, decimals)} %` : '–');
/// An error with as many decimals as in report.md.
const errorText = (value) => {
  const magnitude = Math.abs(value);
  if (isNumber(value) && magnitude >= 1e-9 && magnitude < 1e-4) return value.toExponential(2).replace('-', '−').replace('e-', 'e−');
  return fixed(value, magnitude >= 0.01 || magnitude < 1e-9 ? 4 : magnitude >= 0.001 ? 5 : 6);
};
/// A probability; what would be shown as 0 is bounded.
const probabilityText = (value) => (isNumber(value) && value < 5e-5 ? '< 0.0001' : fixed(value, 4));
/// A name that may be broken behind its joints.
const breakable = (name) => name.split(/(?<=[+_\-])/).flatMap((part, i) => (i === 0 ? [part] : [document.createElement('wbr'), part]));
const counted = (count, noun) => `${count} ${noun}${count === 1 ? '' : 's'}`;

function median(values) {
  const sorted = values.filter(isNumber).sort((a, b) => a - b);
  if (sorted.length === 0) return NaN;
  const middle = sorted.length >> 1;
  return sorted.length % 2 ? sorted[middle] : (sorted[middle - 1] + sorted[middle]) / 2;
}

/// An element with attributes and children. Texts become text nodes, so nothing in a name is ever markup.
function element(tag, attributes = {}, ...children) {
  const isSvg = ['svg', 'line', 'circle', 'rect', 'path', 'text', 'g', 'title'].includes(tag);
  const made = isSvg ? document.createElementNS('http://www.w3.org/2000/svg', tag) : document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith('on')) made.addEventListener(name.slice(2), value);
    else if (value === true) made.setAttribute(name, '');
    else if (value !== false && value !== null && value !== undefined) made.setAttribute(name, value);
  }
  made.append(...children.flat().filter((child) => child !== null && child !== undefined));
  return made;
}
const byId = (id) => document.getElementById(id);
function fill(id, ...children) {
  byId(id).replaceChildren(...children.flat().filter((child) => child !== null));
}

/// Radio buttons in a fieldset; calls back with the key of the one that is chosen.
function makeChoice(id, options, chosen, changed) {
  const fieldset = byId(id);
  for (const [key, label] of Object.entries(options)) {
    fieldset.append(element('label', {}, element('input', {
      type: 'radio', name: id, value: key, checked: key === chosen, onchange: () => changed(key),
    }), element('span', {}, label)));
  }
}

/// `name` in a sentence becomes code.
const withCode = (sentence) =>
    sentence.split('`').map((part, i) => (i % 2 ? element('code', {}, part) : part));

// Every variant has a colour of a scale that people with any colour vision can tell apart, and beyond its end a dash;
// the runs of one variant differ by dash only.
const coloursInScale = 7;
const dashes = [[], [7, 4], [2, 3], [9, 3, 2, 3], [4, 6]];
const style = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const colourOf = (run) => style(`--series-${run.variant % coloursInScale}`);
const cells = new Map(results.cells.map((cell) => [cell.variant * results.sequences.length + cell.sequence, cell]));
const cellOf = (variant, sequence) => cells.get(variant * results.sequences.length + sequence);
const placeOfRun = new Map(results.runs.map((run, i) => [run, i]));
function dashOf(run) {
  const cell = cellOf(run.variant, run.sequence);
  const place = cell ? cell.runs.indexOf(placeOfRun.get(run)) : 0;
  return dashes[(Math.floor(run.variant / coloursInScale) + Math.max(place, 0)) % dashes.length];
}

const variantName = (i) => results.variants[i].name;
const sequenceName = (i) => results.sequences[i].name;
const chanceOf = (run) => [run.seed ? `seed ${run.seed}` : '', run.repeat > 1 || !run.seed ? `run ${run.repeat}` : '']
                              .filter((part) => part).join(', ');

const isShort = (run) => run.result !== null && run.result.coverage < results.minimum_coverage;
const hasTrouble = (run) =>
    !run.counts || isShort(run) || run.result.not_finite > 0 || run.result.malformed > 0;

/// What became of a run, as marks with words in them.
function outcomeMarks(run) {
  if (run.result === null) return [element('span', {class: 'mark'}, 'not done')];
  const marks = [];
  const {status, code, not_finite, malformed, no_errors} = run.result;
  if (status !== 'finished') {
    const reason = {failed: ` (exit code ${code})`, crashed: ` (signal ${code})`}[status] ?? '';
    marks.push(element('span', {class: 'mark bad'}, status + reason));
  }
  if (no_errors !== null) marks.push(element('span', {class: 'mark bad', title: no_errors}, no_errors || 'no trajectory'));
  if (not_finite > 0) marks.push(element('span', {class: 'mark bad'}, `${counted(not_finite, 'pose')} not finite`));
  if (malformed > 0) marks.push(element('span', {class: 'mark warn'}, `${counted(malformed, 'line')} no pose`));
  if (isShort(run)) marks.push(element('span', {class: 'mark warn'}, 'short'));
  return marks.length ? marks : [element('span', {class: 'mark good'}, 'finished')];
}
