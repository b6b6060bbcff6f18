"""Materials, spectra and colour: indices and absorption by wavelength, the eye, the gamut, the screen."""
