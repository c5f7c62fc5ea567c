"""Files of our own: they appear whole or not at all, and what is kept between runs lies in one cache folder."""
