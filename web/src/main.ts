// Where the page begins.
import { mount } from 'svelte';
import './app.css';
import { App } from './page';
import { applyTheme, storedTheme } from './parts';
import { adoptToken } from './session';

applyTheme(storedTheme());
const target = document.getElementById('app');
// First, since everything on the page asks the server at once.
if (target) void adoptToken().then(() => mount(App, { target }));
