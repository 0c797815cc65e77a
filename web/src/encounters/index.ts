// Encounters of robots and people, as a table: chosen, sorted, shown on the floor, seen again.
export {};
