// The page of a picking station, at /station/ID: a display above the opening, with buttons, keys and a scanner. Its
// entry is `main.ts`; it shares the wire, the languages and the theme with the other pages, and nothing else.
export {};
