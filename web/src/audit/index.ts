// Who asked to change something, and what came of it, as a table. Only administrators may read it.
export {};
