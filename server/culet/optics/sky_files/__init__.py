"""Files of skies: equirectangular pictures as .exr, .hdr or .png, read into panoramas of linear Rec. 709 radiance.

OpenImageIO decodes the pixels, a few rows at a time, so that reading takes little more memory than what is kept.
What the header says about the pixels' meaning is ours to honour, to refuse by name, or to tell as a finding; `exr`,
`png` and `radiance` each decide that for one format.
"""
