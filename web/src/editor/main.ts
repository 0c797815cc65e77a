// Where the map editor begins.
import { mount } from 'svelte';
import '../app.css';
import { applyTheme, storedTheme } from '../parts';
import Editor from './Editor.svelte';

applyTheme(storedTheme());
const target = document.getElementById('editor');
if (target) mount(Editor, { target });
