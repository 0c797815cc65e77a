// The cards on the floor, whatever they are about: their frame, and what happened to a thing while the page was open.
// The rooms of robots, people and places fill them.
export type { CardFrame } from './frame';
export { Story, type Line } from './changes';
