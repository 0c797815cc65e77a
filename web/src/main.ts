// Where the page begins.
import { mount } from 'svelte';
import './app.css';
import { App } from './page';
import { applyTheme, storedTheme } from './parts';

applyTheme(storedTheme());
const target = document.getElementById('app');
if (target) mount(App, { target });
