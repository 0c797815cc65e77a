// Where the page begins.
import { mount } from 'svelte';
import './app.css';
import { App } from './page';
import { applyTheme, storedTheme } from './parts';
import { learn } from './words';

applyTheme(storedTheme());
const target = document.getElementById('app');
if (target) void learn().then(() => mount(App, { target }));
