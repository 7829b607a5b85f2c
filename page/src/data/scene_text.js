// The little that the page reads from the scene file itself.

/** Height of the floor [m], or null when the scene has no [ground]. */
export function groundHeight(text) {
  let inGround = false;
  let height = null;
  for (const line of text.split("\n")) {
    const section = line.match(/^\s*\[+\s*([\w.-]+)\s*\]+/);
    if (section) inGround = section[1] === "ground";
    if (section && inGround) height = 0;
    const value = inGround && line.match(/^\s*height\s*=\s*([-+\d._eE]+)/);
    if (value) height = Number(value[1].replaceAll("_", ""));
  }
  return height;
}

/** `[{ kind, text }]` of a line of TOML: "comment", "section", "key" or "value". */
export function tokens(line) {
  const comment = line.match(/^((?:[^"'#]|"(?:[^"\\]|\\.)*"|'[^']*')*)(#.*)?$/s);
  const code = comment?.[1] ?? line;
  const parts = [];
  const key = code.match(/^(\s*[\w."-]+\s*)(=.*)$/s);
  if (/^\s*\[/.test(code)) parts.push({ kind: "section", text: code });
  else if (key) parts.push({ kind: "key", text: key[1] }, { kind: "value", text: key[2] });
  else if (code) parts.push({ kind: "value", text: code });
  if (comment?.[2]) parts.push({ kind: "comment", text: comment[2] });
  return parts;
}
