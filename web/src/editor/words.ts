// The map editor's numbers of things. It speaks English alone.

/** “1 lane”, “2 lanes”. */
export const counted = (n: number, thing: string): string => `${n} ${thing}${n === 1 ? '' : 's'}`;
