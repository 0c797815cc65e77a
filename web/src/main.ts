// Where the page begins.
import { mount } from 'svelte';
import './app.css';
import { App } from './page';
import { applyTheme, storedTheme } from './parts';
import { adoptToken } from './session';
import { learn, learnSaid } from './words';

applyTheme(storedTheme());
const target = document.getElementById('app');
// First the session, since everything on the page asks the server at once; and the words.
if (target) void Promise.all([adoptToken(), learn().then(learnSaid)]).then(() => mount(App, { target }));
