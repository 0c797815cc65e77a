// The card of a person: what the system believes of somebody, how well it sees them, and sending them somewhere.
export { Chances, type Sample } from './chances';
