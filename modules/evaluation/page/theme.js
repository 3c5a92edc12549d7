// Dark or light on every page: as the system has it, until the reader chooses. A plain script in the head, so that a page
// never shows in the other one first. Pages that draw for themselves listen to 'themechange' of the document.
(() => {
  const key = 'holdfast-theme';
  const system = matchMedia('(prefers-color-scheme: dark)');
  // Each run in the browser has a port of its own, and with it a storage of its own; a cookie is for all ports.
  const remembered = () => {
    try {
      return localStorage.getItem(key) ?? document.cookie.match(/(?:^|; )holdfast-theme=(\w+)/)?.[1] ?? '';
    } catch { return ''; }
  };
  const remember = (theme) => {
    try {
      if (theme) localStorage.setItem(key, theme); else localStorage.removeItem(key);
      document.cookie = `${key}=${theme}; path=/; SameSite=Strict; max-age=${theme ? 31536000 : 0}`;
    } catch { /* then only this page has it */ }
  };
  let chosen = remembered();
  const isDark = () => (chosen ? chosen === 'dark' : system.matches);
  // The styles know the system's wish alone: its rules are switched on or off.
  const rules = [];
  const collect = () => {
    for (const sheet of document.styleSheets)
      for (const rule of sheet.cssRules)
        if (rule instanceof CSSMediaRule && /^\(prefers-color-scheme: dark\)$/.test(rule.media.mediaText)) rules.push(rule);
  };
  const button = document.createElement('button');
  button.type = 'button';
  button.className = 'theme';
  const apply = () => {
    for (const rule of rules) rule.media.mediaText = chosen === '' ? '(prefers-color-scheme: dark)' : isDark() ? 'all' : 'not all';
    document.documentElement.style.colorScheme = chosen;
    button.textContent = isDark() ? 'Light' : 'Dark';
    button.title = `Show this page ${isDark() ? 'light' : 'dark'}`;
    document.dispatchEvent(new Event('themechange'));
  };
  button.addEventListener('click', () => {
    const wanted = isDark() ? 'light' : 'dark';
    chosen = wanted === (system.matches ? 'dark' : 'light') ? '' : wanted;  // the system's own needs no memory
    remember(chosen);
    apply();
  });
  system.addEventListener('change', apply);
  collect();
  apply();
  document.addEventListener('DOMContentLoaded', () => (document.querySelector('[data-theme]') ?? document.body).append(button));
})();
