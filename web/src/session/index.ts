// Who is signed in: the page that asks for a token, and what other pages need to sign in and out and to come back. It
// keeps no token: the browser has a cookie, which scripts cannot read.
export { signIn } from './english';
export { learnRights, may, nameHere, roleHere } from './rights.svelte';
export { adoptToken, mayName, signInAt, whoAmI, whoIsHere, type Me, type Who } from './session';
