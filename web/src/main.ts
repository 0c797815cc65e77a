// Where the page begins.
import { mount } from 'svelte';
import './app.css';
import App from './App.svelte';
import { applyTheme, storedTheme } from './theme';

applyTheme(storedTheme());
const target = document.getElementById('app');
if (target) mount(App, { target });
