set(slow_units fit_actor)
