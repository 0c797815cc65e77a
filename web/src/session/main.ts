// Where the page to sign in begins.
import { mount } from 'svelte';
import '../app.css';
import { applyTheme, storedTheme } from '../parts';
import { learn, t } from '../words';
import SignIn from './SignIn.svelte';

applyTheme(storedTheme());
const target = document.getElementById('sign-in');
if (target)
  void learn().then(() => {
    document.title = t('session.title');
    mount(SignIn, { target });
  });
