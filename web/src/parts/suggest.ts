// Names offered while somebody types.

/** At most `limit` names that match, those that begin with the text first: no list of 5,000 options. */
export function suggest(names: readonly string[], text: string, limit = 40): string[] {
  const wanted = text.trim().toLowerCase();
  const first: string[] = [];
  const second: string[] = [];
  for (const name of names) {
    const at = name.toLowerCase().indexOf(wanted);
    if (at === 0) first.push(name);
    else if (at > 0 && second.length < limit) second.push(name);
    if (first.length >= limit) break;
  }
  return [...first, ...second].slice(0, limit);
}
