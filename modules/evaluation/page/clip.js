// Plays the pictures of a run in their own time, in every figure of the class "clip".
document.querySelectorAll('figure.clip').forEach((figure) => {
  const image = figure.querySelector('img');
  const player = figure.querySelector('.player');
  const [button, slider, output] = ['button', 'input', 'output'].map((tag) => player.querySelector(tag));
  const pictures = figure.dataset.pictures.split('\n');
  const names = figure.dataset.names.split('\n');
  const interval = 1000 * Number(figure.dataset.interval);
  const last = pictures.length - 1;
  let wanted = 0, isLoading = false, isPlaying = false;
  let begin = 0;  // when the first picture would have been shown

  const describe = (index) => {
    image.alt = names[index];
    output.textContent = `${names[index]}, ${index + 1} of ${pictures.length}`;
    slider.setAttribute('aria-valuetext', names[index]);
  };
  // A picture is shown when it is decoded, so that none is ever half drawn; those that come too late are left out.
  const show = async (index) => {
    wanted = index;
    if (isLoading) return;
    isLoading = true;
    for (let shown = -1; shown !== wanted;) {
      shown = wanted;
      const next = new Image();
      next.src = pictures[shown];
      try {
        await next.decode();
        image.src = next.src;
        describe(shown);
      } catch {
        output.textContent = `${pictures[shown]} is missing`;
        if (isPlaying) toggle();
      }
    }
    isLoading = false;
  };
  const tick = (now) => {
    if (!isPlaying) return;
    const index = Math.min(last, Math.max(0, Math.floor((now - begin) / interval)));
    if (index !== Number(slider.value)) {
      slider.value = index;
      show(index);
    }
    if (index === last) toggle(); else requestAnimationFrame(tick);
  };
  const beginAt = (index) => { begin = performance.now() - index * interval; };
  const toggle = () => {
    isPlaying = !isPlaying;
    button.textContent = isPlaying ? 'Pause' : 'Play';
    if (!isPlaying) return;
    const at = Number(slider.value);
    beginAt(at === last ? 0 : at);
    requestAnimationFrame(tick);
  };
  button.addEventListener('click', toggle);
  slider.addEventListener('input', () => {
    beginAt(Number(slider.value));
    show(Number(slider.value));
  });
  describe(0);
  player.hidden = false;
});
