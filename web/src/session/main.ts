// Where the page to sign in begins.
import { mount } from 'svelte';
import '../app.css';
import { applyTheme, storedTheme } from '../parts';
import SignIn from './SignIn.svelte';

applyTheme(storedTheme());
const target = document.getElementById('sign-in');
if (target) mount(SignIn, { target });
