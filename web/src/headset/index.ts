// The page of a wearer, at /headset: guidance for one person, in the room or on a map. Its entry is `main.ts`; it
// shares the wire and the theme with the dashboard, and nothing else.
export {};
