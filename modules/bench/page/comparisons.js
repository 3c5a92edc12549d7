// Pairs of variants: a sentence, a verdict, and the gain on every sequence as a picture.

const verdictOf = (comparison) => {
  if (!comparison.enough) return {text: 'too few to tell', kind: ''};
  if (!comparison.significant) return {text: 'not significant', kind: ''};
  const direction = comparison.gain > 0 ? 'better' : 'worse';
  if (!(comparison.p_holm < 0.05)) return {text: `${direction} by itself, not among all comparisons`, kind: ''};
  return {text: `significantly ${direction}`, kind: comparison.gain > 0 ? 'good' : 'bad'};
};

/// The gain on every sequence of a comparison: baseline - variant.
function gainsOf(comparison, quantity) {
  return comparison.sequences.map((sequence) => ({
    sequence,
    gain: cellOf(comparison.before, sequence).errors[quantity].rmse.median -
          cellOf(comparison.after, sequence).errors[quantity].rmse.median,
  }));
}

/// A dot for each sequence, a bar for the interval, a tick for the median; right of the line is better.
function gainPicture(comparison, quantity, range) {
  const width = 600, height = 46, middle = 17, margin = 14;
  const {unit} = quantities[quantity];
  const at = (gain) => margin + (width - 2 * margin) * (gain + range) / (2 * range);
  const gains = gainsOf(comparison, quantity);
  const label = `Gain in ${quantities[quantity].name} RMSE on ` +
      gains.map(({sequence, gain}) => `${sequenceName(sequence)} ${errorText(gain)} ${unit}`).join(', ');
  const picture = element('svg', {viewBox: `0 0 ${width} ${height}`, class: 'gains', role: 'img', 'aria-label': label});
  picture.append(element('line', {x1: margin, x2: width - margin, y1: middle, y2: middle, class: 'axis'}),
                 element('line', {x1: at(0), x2: at(0), y1: 3, y2: 31, class: 'zero'}));
  if (comparison.interval) {
    const [low, high] = comparison.interval;
    picture.append(element('rect', {x: at(low), width: Math.max(at(high) - at(low), 1), y: middle - 6, height: 12, class: 'interval'}));
  }
  for (const {sequence, gain} of gains)
    picture.append(element('circle', {cx: at(gain), cy: middle, r: 4.5, class: 'gain'},
                           element('title', {}, `${sequenceName(sequence)}: ${errorText(gain)} ${unit}`)));
  picture.append(element('line', {x1: at(comparison.gain), x2: at(comparison.gain), y1: middle - 11, y2: middle + 11, class: 'median'}));
  for (const [gain, anchor] of [[-range, 'start'], [0, 'middle'], [range, 'end']])
    picture.append(element('text', {x: anchor === 'middle' ? at(0) : at(gain) + (anchor === 'start' ? -margin + 1 : margin - 1),
                                    y: height - 2, 'text-anchor': anchor},
                           gain === 0 ? '0' : `${gain < 0 ? '← worse, ' : 'better, '}${errorText(Math.abs(gain))} ${unit}${gain > 0 ? ' →' : ''}`));
  return picture;
}

function showComparisons(quantity) {
  const chosen = results.comparisons.filter((comparison) => comparison.quantity === quantities[quantity].name);
  byId('comparisons').hidden = results.comparisons.length === 0;
  const largest = Math.max(...chosen.flatMap((comparison) => [
    ...gainsOf(comparison, quantity).map(({gain}) => Math.abs(gain)), ...(comparison.interval ?? []).map(Math.abs)]), 0);
  const range = largest > 0 ? 1.05 * largest : 1;
  const withPairs = chosen.filter((comparison) => comparison.sequences.length > 0);
  const cards = withPairs.map((comparison) => {
    const verdict = verdictOf(comparison);
    return element('article', {class: 'card'},
                   element('div', {}, element('h3', {}, element('code', {}, variantName(comparison.after)), ' against ',
                                              element('code', {}, variantName(comparison.before)), ' ',
                                              element('span', {class: `mark ${verdict.kind}`}, verdict.text)),
                           element('p', {}, withCode(comparison.sentence))),
                   gainPicture(comparison, quantity, range));
  });
  const others = chosen.filter((comparison) => comparison.sequences.length === 0);
  fill('comparison-cards', cards, others.length === 0 ? null :
       element('ul', {class: 'others'}, others.map((comparison) => element('li', {}, withCode(comparison.sentence)))));
  const {unit} = quantities[quantity];
  fill('comparison-table', sortableTable(`Comparisons: ${quantities[quantity].name} RMSE`, [
    {title: 'variant', value: (c) => variantName(c.after)},
    {title: 'against', value: (c) => variantName(c.before)},
    {title: 'better on', numeric: true, value: (c) => c.better / (c.sequences.length || NaN), cell: (c) => `${c.better} of ${c.sequences.length}`},
    {title: 'gain, median', note: unit, numeric: true, largestFirst: true, value: (c) => c.gain, cell: (c) => errorText(c.gain)},
    {title: 'gain', note: '%', numeric: true, largestFirst: true, value: (c) => c.gain_percent, cell: (c) => fixed(c.gain_percent, 1)},
    {title: '95 % interval', note: unit, numeric: true, value: (c) => c.interval?.[0],
     cell: (c) => (c.interval ? c.interval.map((end) => errorText(end)).join(' to ') : '–')},
    {title: 'pairs', numeric: true, value: (c) => c.pairs},
    {title: 'p', numeric: true, value: (c) => c.p, cell: (c) => probabilityText(c.p)},
    {title: 'p (Holm)', numeric: true, value: (c) => c.p_holm, cell: (c) => probabilityText(c.p_holm)},
    {title: 'verdict', value: (c) => verdictOf(c).text},
  ], chosen));
}
